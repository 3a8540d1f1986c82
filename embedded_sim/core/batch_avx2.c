/* Lanes of AVX2: four a register. */
#include "batch.h"

#ifdef RG_X86
#pragma GCC target("avx2")
#define RG_FORAGE_LANES rg_forage_avx2
#include "group.h"
#endif

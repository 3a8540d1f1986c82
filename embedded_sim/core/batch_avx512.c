/* Lanes of AVX-512: eight a register. */
#include "batch.h"

#ifdef RG_X86
#pragma GCC target("avx512f,avx512dq,avx512bw,avx512vl")
#define RG_FORAGE_LANES rg_forage_avx512
#include "group.h"
#endif

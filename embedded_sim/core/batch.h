/* Trials side by side in SIMD lanes. */
#ifndef RG_BATCH_H
#define RG_BATCH_H

#include "realitygap_core.h"

/* Most trials that run together: groups of lanes, whose instructions overlap. */
enum { RG_TOGETHER = 32 };

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define RG_X86 /* GCC can compile for more than it may assume, and ask the processor at run time   \
                */
#endif

/* Run up to RG_TOGETHER trials of a set, named by their rows, as rg_evaluate does, bit for bit.
 * False: some could not go on, and nothing was written, or this processor has no lanes. */
int rg_forage_lanes(const rg_model *m, const rg_behaviour *b, rg_trials *set, const int32_t *trials,
                    int count);

int rg_forage_avx512(const rg_model *m, const rg_behaviour *b, rg_trials *set,
                     const int32_t *trials, int count);
int rg_forage_avx2(const rg_model *m, const rg_behaviour *b, rg_trials *set, const int32_t *trials,
                   int count);

#endif

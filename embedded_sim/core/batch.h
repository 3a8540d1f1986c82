/* Trials side by side in SIMD lanes. */
#ifndef RG_BATCH_H
#define RG_BATCH_H

#include "realitygap_core.h"

enum { RG_GROUPS = 2, RG_TOGETHER = 16 }; /* groups of lanes, and trials, that run together */

/* Run trials of a set, named by their rows (one may stand twice), as rg_evaluate does, bit
 * for bit. False: some left the finite numbers; nothing was written. */
int rg_forage_lanes(const rg_model *m, const rg_behaviour *b, rg_trials *set,
                    const int32_t trials[RG_TOGETHER]);

#endif

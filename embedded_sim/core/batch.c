/* Which instruction set the lanes run on. */
#include "batch.h"

int32_t rg_has_form(int32_t form) {
#ifdef RG_X86
    if (form == RG_AVX512)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    if (form == RG_AVX2)
        return __builtin_cpu_supports("avx2") != 0;
#endif
    return form == RG_BEST || form == RG_ONE_BY_ONE;
}

int rg_forage_lanes(const rg_model *m, const rg_behaviour *b, rg_trials *set, const int32_t *trials,
                    int count) {
#ifdef RG_X86
    if (set->form == RG_AVX512 || (set->form == RG_BEST && rg_has_form(RG_AVX512)))
        return rg_forage_avx512(m, b, set, trials, count);
    if (set->form == RG_AVX2 || (set->form == RG_BEST && rg_has_form(RG_AVX2)))
        return rg_forage_avx2(m, b, set, trials, count);
#endif
    return 0;
}

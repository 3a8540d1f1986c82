/* xoshiro128++ 1.0 (Blackman and Vigna 2019): 32-bit, so that it runs in SIMD lanes. */
#ifndef RG_RANDOM_H
#define RG_RANDOM_H

#include "realitygap_core.h"

static inline uint32_t rg_rotate(uint32_t x, int k) { return (x << k) | (x >> (32 - k)); }

static inline uint32_t rg_next(rg_random *r) {
    uint32_t *s = r->word;
    const uint32_t result = rg_rotate(s[0] + s[3], 7) + s[0];
    const uint32_t t = s[1] << 9;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rg_rotate(s[3], 11);
    return result;
}

/* uniform in [0, 1) */
static inline double rg_uniform(rg_random *r) { return rg_next(r) * 0x1p-32; }

/* The all-zero state is a fixed point of the generator; it is replaced by an arbitrary constant. */
static inline void rg_seed(rg_random *r, const uint32_t seed[4]) {
    for (int i = 0; i < 4; i++)
        r->word[i] = seed[i];
    if (!(seed[0] | seed[1] | seed[2] | seed[3]))
        r->word[0] = 0x9e3779b9u;
}

#endif

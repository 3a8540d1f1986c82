/* Noise of the sensors by counter: Philox4x32 with 7 rounds (Salmon et al. 2011, the fewest that
 * pass every test of theirs). A block belongs to a trial, a step and a kind of sensor, so that what
 * nobody looks at need not be drawn. */
#ifndef RG_NOISE_H
#define RG_NOISE_H

#include "realitygap_core.h"

enum { RG_NOISE_PS = 0, RG_NOISE_LS = 1 };

/* The block: four words. */
static inline void rg_noise_words(const uint32_t seed[4], uint32_t step, uint32_t kind,
                                  uint32_t word[4]) {
    uint32_t a = step, b = kind, c = seed[2], d = seed[3], k0 = seed[0], k1 = seed[1];
    for (int round = 0; round < 7; round++) {
        const uint64_t first = (uint64_t)a * 0xd2511f53u, second = (uint64_t)c * 0xcd9e8d57u;
        a = (uint32_t)(second >> 32) ^ b ^ k0;
        b = (uint32_t)second;
        c = (uint32_t)(first >> 32) ^ d ^ k1;
        d = (uint32_t)first;
        k0 += 0x9e3779b9u;
        k1 += 0xbb67ae85u;
    }
    word[0] = a;
    word[1] = b;
    word[2] = c;
    word[3] = d;
}

/* Eight uniforms in [-1, 1) of 16 bits each: enough for a 12-bit converter. */
static inline void rg_noise(const uint32_t seed[4], uint32_t step, uint32_t kind, double *noise) {
    uint32_t word[4];
    rg_noise_words(seed, step, kind, word);
    for (int i = 0; i < 4; i++) {
        noise[2 * i] = (double)(int16_t)(word[i] >> 16) * 0x1p-15;
        noise[2 * i + 1] = (double)(int16_t)(word[i] & 0xffffu) * 0x1p-15;
    }
}

#endif

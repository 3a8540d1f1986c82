/* Lanes of doubles, a register of the instruction set compiled for, and the functions of small.h,
 * trig.h and noise.h over them, operation by operation the same: a lane has the bits of a double
 * alone. */
#ifndef RG_LANES_H
#define RG_LANES_H

#include <immintrin.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "batch.h"
#include "small.h"
#include "trig.h"

#ifdef __AVX512DQ__
enum { RG_LANES = 8 };
#else
enum { RG_LANES = 4 };
#endif
enum { RG_GROUPS = RG_TOGETHER / RG_LANES };

typedef double rg_v __attribute__((vector_size(8 * RG_LANES)));   /* numbers */
typedef int64_t rg_m __attribute__((vector_size(8 * RG_LANES)));  /* whole numbers; masks: 0, -1 */
typedef uint64_t rg_u __attribute__((vector_size(8 * RG_LANES))); /* bits */

/* Inlined into each version of the caller: no vector is ever passed by call. */
#define RG_INLINE static inline __attribute__((always_inline))

RG_INLINE rg_v rg_all(double x) { return (rg_v){0} + x; }
RG_INLINE rg_v rg_pick(rg_m mask, rg_v yes, rg_v no) {
    return (rg_v)(((rg_m)yes & mask) | ((rg_m)no & ~mask));
}
RG_INLINE rg_m rg_pick_m(rg_m mask, rg_m yes, rg_m no) { return (yes & mask) | (no & ~mask); }
RG_INLINE rg_v rg_min_v(rg_v a, rg_v b) { return rg_pick(a < b, a, b); }
RG_INLINE rg_v rg_max_v(rg_v a, rg_v b) { return rg_pick(a > b, a, b); }
RG_INLINE rg_v rg_clip_v(rg_v x, double low, double high) {
    return rg_min_v(rg_max_v(x, rg_all(low)), rg_all(high));
}
RG_INLINE rg_v rg_abs_v(rg_v x) { return (rg_v)((rg_m)x & INT64_MAX); }
RG_INLINE rg_v rg_sign_v(rg_v size, rg_v sign) {
    return (rg_v)(((rg_m)size & INT64_MAX) | ((rg_m)sign & INT64_MIN));
}

/* What GCC's vectors have no words for, or it compiles badly: square roots; a mask as bits; numbers
 * without their fraction, and back (within 32 bits); products of 32 bits by 32; two neighbouring
 * floats of a table as bits, and the first of such two as a number. */
#ifdef __AVX512DQ__
RG_INLINE rg_v rg_sqrt_v(rg_v x) { return (rg_v)_mm512_sqrt_pd((__m512d)x); }
RG_INLINE uint64_t rg_which(rg_m mask) { return _mm512_movepi64_mask((__m512i)mask); }
RG_INLINE rg_m rg_whole_v(rg_v x) { return (rg_m)_mm512_cvttpd_epi64((__m512d)x); }
RG_INLINE rg_v rg_number_v(rg_m i) { return (rg_v)_mm512_cvtepi64_pd((__m512i)i); }
RG_INLINE rg_u rg_times_v(rg_u x, uint32_t y) {
    return (rg_u)_mm512_mul_epu32((__m512i)x, _mm512_set1_epi64(y));
}
/* The zeros free the gather from waiting for what its register held before. */
RG_INLINE rg_u rg_pairs_v(const float *table, rg_m index) {
    return (rg_u)_mm512_mask_i64gather_epi64(_mm512_setzero_si512(), 255, (__m512i)index, table,
                                             sizeof *table);
}
RG_INLINE rg_v rg_first_v(rg_u pairs) {
    return (rg_v)_mm512_cvtps_pd(_mm256_castsi256_ps(_mm512_cvtepi64_epi32((__m512i)pairs)));
}
#else
RG_INLINE rg_v rg_sqrt_v(rg_v x) { return (rg_v)_mm256_sqrt_pd((__m256d)x); }
RG_INLINE uint64_t rg_which(rg_m mask) { return (uint64_t)_mm256_movemask_pd((__m256d)mask); }
RG_INLINE rg_m rg_whole_v(rg_v x) {
    return (rg_m)_mm256_cvtepi32_epi64(_mm256_cvttpd_epi32((__m256d)x));
}
/* the low half of each */
RG_INLINE __m128i rg_low_v(rg_u x) {
    const __m256i order = _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6);
    return _mm256_castsi256_si128(_mm256_permutevar8x32_epi32((__m256i)x, order));
}
RG_INLINE rg_v rg_number_v(rg_m i) { return (rg_v)_mm256_cvtepi32_pd(rg_low_v((rg_u)i)); }
RG_INLINE rg_u rg_times_v(rg_u x, uint32_t y) {
    return (rg_u)_mm256_mul_epu32((__m256i)x, _mm256_set1_epi64x(y));
}
RG_INLINE rg_u rg_pairs_v(const float *table, rg_m index) {
    const __m256i all = _mm256_set1_epi64x(-1);
    return (rg_u)_mm256_mask_i64gather_epi64(_mm256_setzero_si256(), (const long long *)table,
                                             (__m256i)index, all, sizeof *table);
}
RG_INLINE rg_v rg_first_v(rg_u pairs) {
    return (rg_v)_mm256_cvtps_pd(_mm_castsi128_ps(rg_low_v(pairs)));
}
#endif

/* For each lane that `which` holds. */
#define RG_EACH(l, which)                                                                          \
    for (uint64_t rest_ = (which), l = 0;                                                          \
         rest_ != 0 && ((l = (uint64_t)__builtin_ctzll(rest_)), 1); rest_ &= rest_ - 1)

/* rg_node */
RG_INLINE rg_m rg_node_v(rg_v u, int n, rg_v *weight) {
    const rg_v s = rg_clip_v(u, 0.0, 1.0) * (double)(n - 1);
    rg_m i = rg_whole_v(s);
    i = rg_pick_m(i > n - 2, (rg_m){0} + (n - 2), i);
    *weight = s - rg_number_v(i);
    return i;
}

/* rg_turn */
RG_INLINE void rg_turn_v(rg_v x, rg_v *sinc, rg_v *cosine) {
    const rg_v q = x * x;
    *sinc = RG_SINC(q);
    *cosine = RG_COS(q);
    RG_EACH(l, rg_which(~(rg_abs_v(x) <= RG_SMALL_TURN))) {
        double one, other;
        rg_turn(x[l], &one, &other);
        (*sinc)[l] = one;
        (*cosine)[l] = other;
    }
}

/* rg_angle */
RG_INLINE rg_v rg_angle_v(rg_v y, rg_v x) {
    const rg_v wide = rg_abs_v(x), high = rg_abs_v(y);
    const rg_v most = rg_max_v(wide, high), least = rg_min_v(wide, high);
    const rg_m steep = least > 0.41421356237309504880 * most;
    const rg_v up = rg_pick(steep, least - most, least);
    const rg_v down = rg_pick(steep, least + most, most);
    const rg_v t = up / rg_max_v(down, rg_all(0x1p-1022));
    const rg_v q = t * t, q2 = q * q;
    const rg_v even = RG_ATAN_EVEN(q2);
    const rg_v odd = RG_ATAN_ODD(q2);
    const rg_v octant = t * (even + q * odd) + rg_pick(steep, rg_all(0.25 * RG_PI), (rg_v){0});
    const rg_v quadrant = rg_pick(high > wide, 0.5 * RG_PI - octant, octant);
    return rg_sign_v(rg_pick(x < 0.0, RG_PI - quadrant, quadrant), y);
}

/* rg_decay */
RG_INLINE rg_v rg_decay_v(rg_v x) {
    const double shift = 0x1.8p52;
    const rg_v shifted = 1.44269504088896340736 * rg_min_v(x, rg_all(700.0)) + shift;
    const rg_v n = shifted - shift;
    const rg_v r = (n * 0x1.62e42feep-1 - x) + n * 1.90821492927058770002e-10;
    const rg_v r2 = r * r;
    const rg_v even = RG_EXP_EVEN(r2);
    const rg_v odd = RG_EXP_ODD(r2);
    const rg_v power = (rg_v)((1023u - (rg_u)shifted) << 52);
    return rg_pick(x > 700.0, (rg_v){0}, power * (even + r * odd));
}

/* rg_noise of a group: noise[k] holds sensor k's. Trials are told apart by lane. */
RG_INLINE void rg_noise_v(const rg_u seed[4], uint32_t step, uint32_t kind, rg_v noise[8]) {
    const rg_u low = (rg_u){0} + UINT32_MAX;
    rg_u a = (rg_u){0} + step, b = (rg_u){0} + kind, c = seed[2], d = seed[3];
    rg_u k0 = seed[0], k1 = seed[1];
    for (int round = 0; round < 7; round++) {
        const rg_u first = rg_times_v(a, 0xd2511f53u), second = rg_times_v(c, 0xcd9e8d57u);
        a = (second >> 32) ^ b ^ k0;
        b = second & low;
        c = (first >> 32) ^ d ^ k1;
        d = first & low;
        k0 = (k0 + 0x9e3779b9u) & low;
        k1 = (k1 + 0xbb67ae85u) & low;
    }
    const rg_u word[4] = {a, b, c, d};
    for (int i = 0; i < 4; i++) {
        const rg_m high = (rg_m)(word[i] << 32) >> 48, rest = (rg_m)(word[i] << 48) >> 48;
        noise[2 * i] = rg_number_v(high) * 0x1p-15;
        noise[2 * i + 1] = rg_number_v(rest) * 0x1p-15;
    }
}

#endif

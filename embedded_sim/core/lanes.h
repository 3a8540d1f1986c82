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
enum {
    RG_GROUPS = RG_TOGETHER / RG_LANES,
    RG_BLOCKS = RG_SENSORS / RG_LANES /* registers that one trial's sensors fill */
};

typedef double rg_v __attribute__((vector_size(8 * RG_LANES)));   /* numbers */
typedef int64_t rg_m __attribute__((vector_size(8 * RG_LANES)));  /* whole numbers; masks: 0, -1 */
typedef uint64_t rg_u __attribute__((vector_size(8 * RG_LANES))); /* bits */

#ifdef __AVX512DQ__
static const rg_m rg_lane = {0, 1, 2, 3, 4, 5, 6, 7};
#else
static const rg_m rg_lane = {0, 1, 2, 3};
#endif

/* Inlined into each version of the caller: no vector is ever passed by call. */
#define RG_INLINE static inline __attribute__((always_inline))

RG_INLINE rg_v rg_all(double x) { return (rg_v){0} + x; }
RG_INLINE rg_v rg_pick(rg_m mask, rg_v yes, rg_v no) {
    return (rg_v)(((rg_m)yes & mask) | ((rg_m)no & ~mask));
}
RG_INLINE rg_m rg_pick_m(rg_m mask, rg_m yes, rg_m no) { return (yes & mask) | (no & ~mask); }
RG_INLINE rg_v rg_abs_v(rg_v x) { return (rg_v)((rg_m)x & INT64_MAX); }
RG_INLINE rg_v rg_sign_v(rg_v size, rg_v sign) {
    return (rg_v)(((rg_m)size & INT64_MAX) | ((rg_m)sign & INT64_MIN));
}

/* What GCC's vectors have no words for, or it compiles badly: the smaller and the larger, as
 * small.h has them; square roots; a mask as bits; numbers without their fraction, and back (within
 * 32 bits); products of 32 bits by 32; two neighbouring floats of a table as bits, and the first of
 * such two as a number; both as numbers, found in `nodes` floats of a row (the registers that hold
 * them may read RG_AHEAD more). */
#ifdef __AVX512DQ__
RG_INLINE rg_v rg_min_v(rg_v a, rg_v b) { return (rg_v)_mm512_min_pd((__m512d)a, (__m512d)b); }
RG_INLINE rg_v rg_max_v(rg_v a, rg_v b) { return (rg_v)_mm512_max_pd((__m512d)a, (__m512d)b); }
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
RG_INLINE void rg_neighbours_v(const float *row, rg_m index, int nodes, rg_v both[2]) {
    const __m256i low = _mm512_cvtepi64_epi32((__m512i)index);
    const __m256i high = _mm256_add_epi32(low, _mm256_set1_epi32(1));
    const __m512i wanted = _mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1);
    /* of an index, two registers' permutation reads the low bits */
    __m512 found = _mm512_permutex2var_ps(_mm512_loadu_ps(row), wanted, _mm512_loadu_ps(row + 16));
    for (int at = 32; at < nodes; at += 32) {
        const __m512 further = _mm512_permutex2var_ps(_mm512_loadu_ps(row + at), wanted,
                                                      _mm512_loadu_ps(row + at + 16));
        const __mmask16 there = _mm512_cmpge_epi32_mask(wanted, _mm512_set1_epi32(at));
        found = _mm512_mask_mov_ps(found, there, further);
    }
    both[0] = (rg_v)_mm512_cvtps_pd(_mm512_castps512_ps256(found));
    both[1] = (rg_v)_mm512_cvtps_pd(_mm512_extractf32x8_ps(found, 1));
}
#else
RG_INLINE rg_v rg_min_v(rg_v a, rg_v b) { return (rg_v)_mm256_min_pd((__m256d)a, (__m256d)b); }
RG_INLINE rg_v rg_max_v(rg_v a, rg_v b) { return (rg_v)_mm256_max_pd((__m256d)a, (__m256d)b); }
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
RG_INLINE void rg_neighbours_v(const float *row, rg_m index, int nodes, rg_v both[2]) {
    (void)nodes;
    const rg_u pairs = rg_pairs_v(row, index);
    both[0] = rg_first_v(pairs);
    both[1] = rg_first_v(pairs >> 32);
}
#endif

RG_INLINE rg_v rg_clip_v(rg_v x, double low, double high) {
    return rg_min_v(rg_max_v(x, rg_all(low)), rg_all(high));
}

RG_INLINE rg_v rg_load_v(const double *x) {
    rg_v lanes;
    memcpy(&lanes, x, sizeof lanes);
    return lanes;
}

/* A number put into lane l, in a register: a vector that is read back right after a part of it was
 * written to memory waits for the write. */
RG_INLINE rg_v rg_put_v(rg_v x, uint64_t l, double number) {
    return rg_pick(rg_lane == (int64_t)l, rg_all(number), x);
}
RG_INLINE rg_m rg_put_m(rg_m x, uint64_t l, int64_t number) {
    return rg_pick_m(rg_lane == (int64_t)l, (rg_m){0} + number, x);
}

/* Lane j of row i becomes lane i of row j: blocks off the diagonal change places, from the smallest
 * to the largest. */
RG_INLINE void rg_transpose_v(rg_v rows[RG_LANES]) {
    for (int side = 1; side < RG_LANES; side *= 2)
        for (int i = 0; i < RG_LANES; i++) {
            if (i & side)
                continue;
            const rg_v above = rows[i], below = rows[i + side];
            const rg_m odd = (rg_lane & side) != 0;
            const rg_m upper = rg_pick_m(odd, rg_lane - side + RG_LANES, rg_lane);
            const rg_m lower = rg_pick_m(odd, rg_lane + RG_LANES, rg_lane + side);
            rows[i] = __builtin_shuffle(above, below, upper);
            rows[i + side] = __builtin_shuffle(above, below, lower);
        }
}

/* Bits of lanes as a mask. */
RG_INLINE rg_m rg_mask_v(uint64_t which) {
    return (((rg_m){0} + (int64_t)which) & ((rg_m){0} + 1) << rg_lane) != 0;
}

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

/* rg_two_to */
RG_INLINE rg_v rg_two_to_v(rg_v x) {
    const double shift = 0x1.8p52;
    const rg_v clipped = rg_clip_v(x, -1000.0, 1000.0), shifted = clipped + shift;
    const rg_v r = (clipped - (shifted - shift)) * RG_LN2, r2 = r * r;
    const rg_v power = (rg_v)((1023u + (rg_u)shifted) << 52);
    return power * RG_EXP(r, r2);
}

/* rg_power */
RG_INLINE rg_v rg_power_v(rg_v x, double p) {
    const rg_m e = (rg_m)((rg_u)x - RG_HALF_ROOT) >> 52;
    const rg_v m = (rg_v)((rg_u)x - ((rg_u)e << 52));
    const rg_v t = (m - 1.0) / (m + 1.0), q = t * t;
    const rg_v found = rg_two_to_v(p * (rg_number_v(e) + RG_LOG2_E * 2.0 * t * RG_ATANH(q)));
    return p == 0.0 ? found : rg_pick(x > 0.0, found, (rg_v){0});
}

/* rg_noise of a group, times `width`: noise[k] holds sensor k's. Trials are told apart by lane. A
 * word is the low half of its lane: no product reads what is above, and the last shifts drop it. */
RG_INLINE void rg_noise_v(const rg_u seed[4], uint32_t step, uint32_t kind, double width,
                          rg_v noise[8]) {
    rg_u a = (rg_u){0} + step, b = (rg_u){0} + kind, c = seed[2], d = seed[3];
    rg_u k0 = seed[0], k1 = seed[1];
    for (int round = 0; round < 7; round++) {
        const rg_u first = rg_times_v(a, 0xd2511f53u), second = rg_times_v(c, 0xcd9e8d57u);
        a = (second >> 32) ^ b ^ k0;
        b = second;
        c = (first >> 32) ^ d ^ k1;
        d = first;
        k0 += 0x9e3779b9u;
        k1 += 0xbb67ae85u;
    }
    const double unit = 0x1p-15 * width; /* a power of two rounds nothing, wherever it comes in */
    const rg_u word[4] = {a, b, c, d};
    for (int i = 0; i < 4; i++) {
        const rg_m high = (rg_m)(word[i] << 32) >> 48, rest = (rg_m)(word[i] << 48) >> 48;
        noise[2 * i] = unit * rg_number_v(high);
        noise[2 * i + 1] = unit * rg_number_v(rest);
    }
}

/* rg_noise of one trial, from its words: sensors k, k + 1, ... in lanes. */
RG_INLINE rg_v rg_noise_of_v(const uint32_t word[4], int k) {
    const int64_t first = (int64_t)((uint64_t)word[1] << 32 | word[0]);
    const int64_t rest = (int64_t)((uint64_t)word[3] << 32 | word[2]);
    const rg_m words = rg_pick_m(rg_lane + k < 4, (rg_m){0} + first, (rg_m){0} + rest);
    const rg_m above = (32 + 16 * rg_lane) & 63; /* bits above a sensor's 16 */
    return rg_number_v((rg_m)((rg_u)words << (rg_u)above) >> 48) * 0x1p-15;
}

#endif

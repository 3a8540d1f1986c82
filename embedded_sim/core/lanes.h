/* Eight lanes of doubles, and the functions of small.h, trig.h and noise.h over them, operation by
 * operation the same, so that a lane has the bits of a double alone. The vectors are GCC's: each
 * instruction set gets as many registers of its own width as eight doubles need. */
#ifndef RG_LANES_H
#define RG_LANES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "small.h"
#include "trig.h"

enum { RG_LANES = 8 };

typedef double rg_v __attribute__((vector_size(64)));   /* numbers */
typedef int64_t rg_m __attribute__((vector_size(64)));  /* whole numbers; masks: 0 or -1 */
typedef uint64_t rg_u __attribute__((vector_size(64))); /* bits */
typedef int32_t rg_i __attribute__((vector_size(32)));  /* on the way between the two */
typedef float rg_f __attribute__((vector_size(32)));
typedef int8_t rg_bytes __attribute__((vector_size(8))); /* masks, a byte each */

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
RG_INLINE rg_v rg_sqrt_v(rg_v x) {
    rg_v root;
    for (int l = 0; l < RG_LANES; l++)
        root[l] = __builtin_sqrt(x[l]);
    return root;
}
/* A mask as bytes: lane l holds in bits 8 l to 8 l + 7. Zero: none. */
RG_INLINE uint64_t rg_which(rg_m mask) {
    const rg_bytes bytes = __builtin_convertvector(mask, rg_bytes);
    uint64_t bits;
    memcpy(&bits, &bytes, sizeof bits);
    return bits;
}
/* For each lane that `which` holds. */
#define RG_EACH(l, which)                                                                          \
    for (uint64_t rest_ = (which), l = 0;                                                          \
         rest_ != 0 && ((l = (uint64_t)__builtin_ctzll(rest_) / 8), 1);                            \
         rest_ &= ~(UINT64_C(255) << (8 * l)))

/* Numbers without their fraction, and back; within 32 bits, which every instruction set converts.
 */
RG_INLINE rg_m rg_whole_v(rg_v x) {
    return __builtin_convertvector(__builtin_convertvector(x, rg_i), rg_m);
}
RG_INLINE rg_v rg_number_v(rg_m i) {
    return __builtin_convertvector(__builtin_convertvector(i, rg_i), rg_v);
}

/* rg_node */
RG_INLINE rg_m rg_node_v(rg_v u, int n, rg_v *weight) {
    const rg_v s = rg_clip_v(u, 0.0, 1.0) * (double)(n - 1);
    rg_m i = rg_whole_v(s);
    i = rg_pick_m(i > n - 2, (rg_m){0} + (n - 2), i);
    *weight = s - rg_number_v(i);
    return i;
}

/* Two neighbouring floats of a table as bits, and the first of such two as a number. */
RG_INLINE uint64_t rg_pair(const float *table) {
    uint64_t bits;
    memcpy(&bits, table, sizeof bits);
    return bits;
}
RG_INLINE rg_v rg_first(rg_u pairs) {
    return __builtin_convertvector((rg_f) __builtin_convertvector(pairs, rg_i), rg_v);
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

/* rg_noise of eight trials: noise[k] holds sensor k's. Trials are told apart by lane. */
RG_INLINE void rg_noise_v(const rg_u seed[4], uint32_t step, uint32_t kind, rg_v noise[8]) {
    const rg_u low = (rg_u){0} + UINT32_MAX;
    rg_u a = (rg_u){0} + step, b = (rg_u){0} + kind, c = seed[2], d = seed[3];
    rg_u k0 = seed[0], k1 = seed[1];
    for (int round = 0; round < 7; round++) {
        const rg_u first = a * 0xd2511f53u, second = c * 0xcd9e8d57u;
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

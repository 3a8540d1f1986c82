/* The functions of angles, of decay and of powers that a control step needs, as polynomials: no
 * call, no branch, the same bits on every machine and in every lane of a batch. Relative errors,
 * but of powers, stay below 6e-16 (three roundings of a double). */
#ifndef RG_TRIG_H
#define RG_TRIG_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "small.h"

#define RG_PI 3.14159265358979323846
#define RG_LN2 0.69314718055994530942
#define RG_LOG2_E 1.44269504088896340736
#define RG_SMALL_TURN 0.25 /* rad: half a step's turn is far below it, up to 12 rad/s */

/* The polynomials, of doubles and of vectors of doubles alike.
 * sin(x) / x and cos(x) in q = x^2, |x| <= RG_SMALL_TURN: Taylor, cut where a term is below 1e-17
 */
#define RG_SINC(q)                                                                                 \
    (1.0 + q * (-1.0 / 6 +                                                                         \
                q * (1.0 / 120 + q * (-1.0 / 5040 + q * (1.0 / 362880 + q * (-1.0 / 39916800))))))
#define RG_COS(q)                                                                                  \
    (1.0 + q * (-0.5 + q * (1.0 / 24 +                                                             \
                            q * (-1.0 / 720 + q * (1.0 / 40320 + q * (-1.0 / 3628800 +             \
                                                                      q * (1.0 / 479001600)))))))
/* atan(t) / t in q = t^2, |t| <= tan(pi/8): meets it at the eleven Chebyshev nodes (relative error
 * 3e-17). Even and odd powers of q apart, in q2 = q^2: two short chains instead of a long one. */
#define RG_ATAN_EVEN(q2)                                                                           \
    (1.0 + q2 * (0.1999999999885511 +                                                              \
                 q2 * (0.11111106180455946 +                                                       \
                       q2 * (0.07689953496306857 +                                                 \
                             q2 * (0.056883492268090106 + q2 * (0.021135373157693246))))))
#define RG_ATAN_ODD(q2)                                                                            \
    (-0.3333333333332844 +                                                                         \
     q2 * (-0.14285714180976467 +                                                                  \
           q2 * (-0.09090773074808414 +                                                            \
                 q2 * (-0.06640233930429408 + q2 * (-0.04348052215716462)))))
/* exp(r), |r| <= ln(2) / 2: Taylor, even and odd powers of r apart, in r2 = r^2 */
#define RG_EXP_EVEN(r2)                                                                            \
    (1.0 + r2 * (0.5 + r2 * (1.0 / 24 + r2 * (1.0 / 720 + r2 * (1.0 / 40320 +                      \
                                                                r2 * (1.0 / 3628800 +              \
                                                                      r2 * (1.0 / 479001600)))))))
#define RG_EXP_ODD(r2)                                                                             \
    (1.0 + r2 * (1.0 / 6 +                                                                         \
                 r2 * (1.0 / 120 +                                                                 \
                       r2 * (1.0 / 5040 + r2 * (1.0 / 362880 + r2 * (1.0 / 39916800 +              \
                                                                     r2 * (1.0 / 6227020800)))))))

/* atanh(t) / t in q = t^2, |t| <= 3 - 2 sqrt(2), and exp(r), |r| <= ln(2) / 2: Taylor, cut where a
 * term is below 1e-8: laws need no more */
#define RG_ATANH(q) (1.0 + q * (1.0 / 3 + q * (1.0 / 5 + q * (1.0 / 7 + q * (1.0 / 9)))))
#define RG_EXP(r, r2)                                                                              \
    ((1.0 + r2 * (0.5 + r2 * (1.0 / 24 + r2 * (1.0 / 720)))) +                                     \
     r * (1.0 + r2 * (1.0 / 6 + r2 * (1.0 / 120 + r2 * (1.0 / 5040)))))
#define RG_HALF_ROOT 0x3fe6a09e667f3bcdu /* bits of the square root of 1 / 2 */

/* sin(x) / x and cos(x) for any x */
static inline void rg_turn(double x, double *sinc, double *cosine) {
    const double q = x * x;
    if (fabs(x) <= RG_SMALL_TURN) {
        *sinc = RG_SINC(q);
        *cosine = RG_COS(q);
    } else {
        *sinc = sin(x) / x;
        *cosine = cos(x);
    }
}

/* Angle (rad) of the vector (x, y) in [-pi, pi]; 0 for the null vector. The octant's ratio is
 * brought to |t| <= tan(pi/8), where atan(t) / t is a polynomial in t^2 that meets it at the eleven
 * Chebyshev nodes (relative error 3e-17). */
static inline double rg_angle(double y, double x) {
    const double wide = fabs(x), high = fabs(y);
    const double most = rg_max(wide, high), least = rg_min(wide, high);
    const int steep = least > 0.41421356237309504880 * most;
    const double up = steep ? least - most : least;
    const double down = steep ? least + most : most;
    const double t = up / rg_max(down, 0x1p-1022);
    const double q = t * t, q2 = q * q;
    const double even = RG_ATAN_EVEN(q2);
    const double odd = RG_ATAN_ODD(q2);
    const double octant = t * (even + q * odd) + (steep ? 0.25 * RG_PI : 0.0);
    const double quadrant = high > wide ? 0.5 * RG_PI - octant : octant;
    return copysign(x < 0.0 ? RG_PI - quadrant : quadrant, y);
}

/* exp(-x) for x >= 0, and 0 beyond 700: exp(-x) = 2^-n exp(r), |r| <= ln(2) / 2, Taylor series */
static inline double rg_decay(double x) {
    const double shift = 0x1.8p52; /* added, it leaves a whole number in the low bits */
    const double shifted = 1.44269504088896340736 * rg_min(x, 700.0) + shift;
    const double n = shifted - shift;
    /* ln(2) in two parts, the first short enough for its product with n to be exact */
    const double r = (n * 0x1.62e42feep-1 - x) + n * 1.90821492927058770002e-10;
    const double r2 = r * r;
    const double even = RG_EXP_EVEN(r2);
    const double odd = RG_EXP_ODD(r2);
    uint64_t bits;
    memcpy(&bits, &shifted, sizeof bits);
    bits = (1023u - bits) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return x > 700.0 ? 0.0 : power * (even + r * odd);
}

/* 2^x within 1e-8 of itself, from 2^-1000 to 2^1000 */
static inline double rg_two_to(double x) {
    const double shift = 0x1.8p52;
    const double clipped = rg_clip(x, -1000.0, 1000.0), shifted = clipped + shift;
    const double r = (clipped - (shifted - shift)) * RG_LN2, r2 = r * r;
    uint64_t bits;
    memcpy(&bits, &shifted, sizeof bits);
    bits = (1023u + bits) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power * RG_EXP(r, r2);
}

/* x^p for x >= 0 and p >= 0, as rg_two_to, and 2e-9 p log(x) worse: log(x) = e ln(2) + 2 atanh((m -
 * 1) / (m + 1)), x = 2^e m with m about 1. */
static inline double rg_power(double x, double p) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    const int64_t e = (int64_t)(bits - RG_HALF_ROOT) >> 52;
    bits -= (uint64_t)e << 52;
    double m;
    memcpy(&m, &bits, sizeof m);
    const double t = (m - 1.0) / (m + 1.0), q = t * t;
    const double found = rg_two_to(p * ((double)e + RG_LOG2_E * 2.0 * t * RG_ATANH(q)));
    return x > 0.0 || p == 0.0 ? found : 0.0;
}

#endif

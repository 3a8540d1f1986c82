/* What the core takes: every structure is looked at once per call, before anything is computed from
 * it, so that no later lookup, loop or conversion needs to doubt a number. */
#ifndef RG_CHECK_H
#define RG_CHECK_H

#include <float.h>
#include <math.h>
#include <stddef.h>

#include "realitygap_core.h"
#include "trig.h"

/* Ranges, as (least, most). They hold every robot and log there may be, and keep whatever a trial
 * works out finite: squares of lengths, products of gains, speeds over an axle. */
#define RG_MOST 1e12 /* gains, counts, seconds, rad/s and their rates */
#define RG_FAR 1e4   /* m: up to it, RG_MARGIN is more than rounding */
#define RG_ANY -RG_MOST, RG_MOST
#define RG_NOT_NEGATIVE 0.0, RG_MOST
#define RG_LIMIT 0.0, INFINITY
#define RG_DIVISOR 1e-12, INFINITY
#define RG_PLACE -RG_FAR, RG_FAR
#define RG_WAY 0.0, RG_FAR
#define RG_LENGTH 1e-9, RG_FAR    /* above 0 */
#define RG_CONTROL_STEP 1e-6, 1e3 /* s */
#define RG_LAW_SCALE 1e-6, RG_MOST
#define RG_LAW_EXPONENT 0.0, 10.0
#define RG_LAW_HARMONIC 0.0, 8.0
#define RG_SHARE -1.0, 1.0        /* a cosine or sine */
#define RG_DATA -DBL_MAX, DBL_MAX /* of a log: only finite */
#define RG_ROWS 0.0, 0x1p53       /* whole numbers that a double holds */

/* Is a number finite? (An infinity or NaN less itself is no number.) */
static inline int rg_finite(double x) { return x - x == 0.0; }

static inline int rg_within(rg_refusal *why, const char *field, int64_t index, double got,
                            double low, double high) {
    if (got >= low && got <= high)
        return 1;
    *why = (rg_refusal){field, index, 0, got, low, high};
    return 0;
}

static inline int rg_all_within(rg_refusal *why, const char *field, const double *got, int count,
                                double low, double high) {
    for (int i = 0; i < count; i++)
        if (!rg_within(why, field, i, got[i], low, high))
            return 0;
    return 1;
}

/* An array that has elements has a place. */
static inline int rg_there(rg_refusal *why, const char *field, const void *array, int64_t count) {
    if (array != NULL || count == 0)
        return 1;
    *why = (rg_refusal){field, -1, 0, 0.0, (double)count, (double)count};
    return 0;
}

#endif

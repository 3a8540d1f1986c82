/* Minimum and maximum that compile to one instruction: fmin and fmax must mind NaN and are called.
 */
#ifndef RG_SMALL_H
#define RG_SMALL_H

static inline double rg_min(double a, double b) { return a < b ? a : b; }
static inline double rg_max(double a, double b) { return a > b ? a : b; }
static inline double rg_clip(double x, double low, double high) {
    return rg_min(rg_max(x, low), high);
}

#endif

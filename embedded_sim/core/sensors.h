/* What the point model's sensors read: captured tables, looked up bilinearly (III-E). */
#ifndef RG_SENSORS_H
#define RG_SENSORS_H

#include <math.h>
#include <string.h>

#include "realitygap_core.h"
#include "small.h"
#include "trig.h"

#define RG_TWO_PI 6.28318530717958647692

/* Lower node and weight of the upper node, on a uniform axis of n nodes over [0, 1]. */
static inline int rg_node(double u, int n, double *weight) {
    const double s = rg_clip(u, 0.0, 1.0) * (n - 1);
    int i = (int)s;
    if (i > n - 2)
        i = n - 2;
    *weight = s - i;
    return i;
}

/* Does a ray from the rim along (ux, uy) meet the circular wall around the origin within `reach`?
 */
static inline int rg_sees_wall(const rg_model *m, double x, double y, double ux, double uy,
                               double reach) {
    const double px = x + m->body_radius * ux, py = y + m->body_radius * uy;
    const double along = px * ux + py * uy;
    const double margin = m->arena_radius * m->arena_radius - px * px - py * py;
    return !(reach * (2.0 * along + reach) <= margin);
}

/* Infrared of sensor k at the rim, looking along (ux, uy) at the wall. */
static inline double rg_wall_reading(const rg_model *m, int k, double x, double y, double ux,
                                     double uy) {
    const rg_tables *t = &m->tables;
    const double px = x + m->body_radius * ux, py = y + m->body_radius * uy;
    const double along = px * ux + py * uy;
    const double margin = m->arena_radius * m->arena_radius - px * px - py * py;
    if (t->ps_range * (2.0 * along + t->ps_range) <= margin)
        return 0.0; /* the ray ends before the wall */
    const double inside = along * along + margin;
    if (inside <= 0.0)
        return 0.0; /* the rim is outside and looks away: contact is not the point model's business
                     */
    const double root = sqrt(inside);
    const double distance = rg_max(root - along, 0.0);
    double wd, wi;
    const int i = rg_node(sqrt(distance / t->ps_range), t->ps_distances, &wd);
    const int j = rg_node(root / m->arena_radius, t->ps_incidences, &wi);
    const float *low = t->ps_counts + ((int64_t)k * t->ps_distances + i) * t->ps_incidences + j;
    const float *high = low + t->ps_incidences;
    return (1.0 - wd) * ((1.0 - wi) * low[0] + wi * low[1]) +
           wd * ((1.0 - wi) * high[0] + wi * high[1]);
}

/* All infrared sensors at a pose (c, s: cosine and sine of yaw), without noise. */
static inline void rg_ps(const rg_model *m, double x, double y, double c, double s, double *ps) {
    memcpy(ps, m->ps_offset, sizeof m->ps_offset);
    const double free = m->arena_radius - m->body_radius - m->tables.ps_range;
    if (free > 0.0 && x * x + y * y < free * free)
        return; /* no sensor can see the wall from here */
    for (int k = 0; k < RG_SENSORS; k++) {
        const double ux = c * m->sensor_cos[k] - s * m->sensor_sin[k];
        const double uy = s * m->sensor_cos[k] + c * m->sensor_sin[k];
        ps[k] += m->ps_gain[k] * rg_wall_reading(m, k, x, y, ux, uy);
    }
}

/* What a lamp at (dx, dy) from the robot takes off the light sensors' counts. */
static inline void rg_lamp(const rg_model *m, double dx, double dy, double gain, double c, double s,
                           double *ls) {
    const rg_tables *t = &m->tables;
    const double bearing = rg_clip(rg_angle(c * dy - s * dx, c * dx + s * dy), -RG_PI, RG_PI);
    double wd;
    const int i = rg_node(sqrt(sqrt(dx * dx + dy * dy) / t->ls_range), t->ls_distances, &wd);
    const int around = 3 * t->ls_bearings + 1;
    const float *low = t->ls_counts + (int64_t)i * around;
    const float *high = low + around;
    const double per_rad = t->ls_bearings / RG_TWO_PI;
    for (int k = 0; k < RG_SENSORS; k++) {
        /* bearing and sensor angle lie in [-pi, pi]: the three copies of the circle hold their
         * difference */
        const double at = (bearing - m->sensor_angle[k] + 1.5 * RG_TWO_PI) * per_rad;
        const int j = (int)at;
        const double wb = at - j;
        const double lit = (1.0 - wd) * ((1.0 - wb) * low[j] + wb * low[j + 1]) +
                           wd * ((1.0 - wb) * high[j] + wb * high[j + 1]);
        ls[k] -= m->ls_gain[k] * gain * lit;
    }
}

/* All light sensors at a pose, without noise: dark, minus what the lamps add. `time` is the lamp's
 * age (s). */
static inline void rg_ls(const rg_model *m, int scenario, double x, double y, double c, double s,
                         double time, double *ls) {
    for (int k = 0; k < RG_SENSORS; k++)
        ls[k] = m->tables.ls_dark[k];
    if (m->lamp_on[scenario]) {
        const double gain = m->lamp_gain * rg_max(1.0 - m->lamp_decay * time, 0.0);
        rg_lamp(m, m->lamp_x[scenario] - x, m->lamp_y[scenario] - y, gain, c, s, ls);
    }
    if (m->second_gain > 0.0)
        rg_lamp(m, m->second_x - x, m->second_y - y, m->second_gain, c, s, ls);
    for (int k = 0; k < RG_SENSORS; k++)
        ls[k] = rg_max(ls[k], 0.0);
}

#endif

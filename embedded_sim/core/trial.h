/* One simulated robot that forages (III-E), piece by piece. Both forms of the simulator are put
 * together from these, and leave out only what cannot change a decision. */
#ifndef RG_TRIAL_H
#define RG_TRIAL_H

#include <math.h>
#include <string.h>

#include "behaviour.h"
#include "drive.h"
#include "noise.h"
#include "random.h"
#include "realitygap_core.h"
#include "sensors.h"
#include "small.h"

#define RG_MARGIN 1e-9 /* relative, and in m: far above rounding, far below what matters */

static inline int rg_on_nest(const rg_model *m, double x, double y) {
    const double dx = x - m->nest_x, dy = y - m->nest_y;
    return dx * dx + dy * dy < m->nest_radius * m->nest_radius;
}

/* Uniform over the part of the arena a robot's centre can reach. */
static inline void rg_place(const rg_model *m, rg_random *r, double *x, double *y) {
    const double reach = m->arena_radius - m->body_radius;
    const double radius = reach * sqrt(rg_uniform(r));
    const double angle = RG_TWO_PI * rg_uniform(r);
    *x = radius * cos(angle);
    *y = radius * sin(angle);
}

/* The same, outside the nest: nobody is paid for food that lies at home. False: RG_DRAWS places
 * were all on it. */
static inline int rg_place_food(const rg_model *m, rg_random *r, double *x, double *y) {
    for (int draw = 0; draw < RG_DRAWS; draw++) {
        rg_place(m, r, x, y);
        if (!rg_on_nest(m, *x, *y))
            return 1;
    }
    return 0;
}

/* Where a trial begins. */
typedef struct {
    double pose[3];
    double heading[2]; /* cosine and sine of yaw */
    rg_controller controller;
    rg_random random; /* places; the controller has its own stream, and noise goes by counter */
} rg_beginning;

/* False: there is no room for food. */
static inline int rg_begin(const rg_model *m, const uint32_t seed[4], rg_beginning *start,
                           double *food_x, double *food_y) {
    rg_random *random = &start->random;
    rg_seed(random, seed);
    uint32_t own[4];
    for (int i = 0; i < 4; i++)
        own[i] = rg_next(random);
    rg_controller_start(&start->controller, own);
    rg_place(m, random, &start->pose[0], &start->pose[1]);
    start->pose[2] = RG_TWO_PI * rg_uniform(random);
    start->heading[0] = cos(start->pose[2]);
    start->heading[1] = sin(start->pose[2]);
    for (int i = 0; i < m->food_items; i++)
        if (!rg_place_food(m, random, &food_x[i], &food_y[i]))
            return 0;
    return 1;
}

/* What of model and controller a trial asks for at every step, worked out once. */
typedef struct {
    rg_pace pace;
    double reach[RG_SENSORS]; /* m; a wall beyond it is no obstacle to sensor k; 0: nothing is */
    double near_square;       /* m^2; nearer to the arena's centre than this, nothing is */
    int32_t taxis[2];         /* -1, 0, +1 without food, with food */
} rg_watch;

/* Farthest distance (m) at which sensor k can read its threshold, noise included. */
static inline double rg_reach(const rg_model *m, const rg_behaviour *b, int k) {
    const rg_tables *t = &m->tables;
    const double gain = m->ps_gain[k], offset = m->ps_offset[k];
    const double wanted = b->avoid_threshold[k] * (1.0 - RG_MARGIN);
    if (isinf(wanted) && wanted > 0.0)
        return 0.0;
    const double most = 1.0 + t->ps_noise[k], floor = t->ps_noise_floor;
    if (!(gain >= 0.0 && offset >= 0.0 && wanted > 0.0 && offset * most + floor < wanted))
        return INFINITY;
    const int32_t row = t->ps_incidences, all = t->ps_distances * row;
    const float *counts = t->ps_counts + (int64_t)k * all;
    int32_t i = all - 1;
    while (i >= 0 && !((offset + gain * counts[i]) * most + floor >= wanted))
        i--;
    if (i < 0)
        return 0.0;
    /* readings fall to the next node's only there */
    const double u = rg_min((i / row + 1.0) / (t->ps_distances - 1), 1.0);
    return t->ps_range * u * u * (1.0 + RG_MARGIN);
}

static inline rg_watch rg_watch_of(const rg_model *m, const rg_behaviour *b, const double genome[2],
                                   int32_t scenario) {
    rg_watch w = {.pace = rg_pace_of(b), .near_square = INFINITY};
    double farthest = 0.0;
    for (int k = 0; k < RG_SENSORS; k++) {
        w.reach[k] = rg_reach(m, b, k);
        farthest = rg_max(farthest, w.reach[k]);
    }
    const double near = m->arena_radius - m->body_radius - farthest - RG_MARGIN;
    if (farthest > 0.0)
        w.near_square = near > 0.0 ? near * near : 0.0;
    /* without a lamp only the noise of the sensors could be taken for one */
    const int lit = m->lamp_on[scenario] || m->second_gain > 0.0 ||
                    2.0 * m->tables.ls_noise >= b->light_contrast;
    for (int food = 0; food < 2; food++)
        w.taxis[food] = lit ? rg_third(genome[!food]) - 1 : 0;
    return w;
}

/* Side of an obstacle that the infrared sensors see, as rg_obstacle has it. */
static inline int32_t rg_look_ahead(const rg_model *m, const rg_behaviour *b, const rg_watch *w,
                                    const uint32_t seed[4], uint32_t step, const double *pose,
                                    const double *heading) {
    const rg_tables *t = &m->tables;
    const double x = pose[0], y = pose[1], c = heading[0], s = heading[1];
    double noise[RG_SENSORS], strongest[2] = {0.0, 0.0}; /* right, left; in thresholds */
    int drawn = 0;
    for (int k = 0; k < RG_SENSORS; k++) {
        if (w->reach[k] <= 0.0)
            continue;
        const double ux = c * m->sensor_cos[k] - s * m->sensor_sin[k];
        const double uy = s * m->sensor_cos[k] + c * m->sensor_sin[k];
        if (!rg_sees_wall(m, x, y, ux, uy, w->reach[k]))
            continue;
        const double wall = m->ps_gain[k] * rg_wall_reading(m, k, x, y, ux, uy);
        const double ps = m->ps_offset[k] + wall;
        const double noisy = t->ps_noise[k] * wall + t->ps_noise_floor;
        if (ps + fabs(noisy) < b->avoid_threshold[k] * (1.0 - RG_MARGIN))
            continue; /* whatever the noise */
        if (!drawn)
            rg_noise(seed, step, RG_NOISE_PS, noise);
        drawn = 1;
        const double near = ps + noisy * noise[k];
        const double read = rg_clip(near, 0.0, t->counts_max);
        strongest[k >= 4] = rg_max(strongest[k >= 4], read / b->avoid_threshold[k]);
    }
    return rg_obstacle(strongest[0], strongest[1]);
}

/* What the light sensors read, noise included. */
static inline void rg_see_light(const rg_model *m, const uint32_t seed[4], uint32_t step,
                                int32_t scenario, const double *pose, const double *heading,
                                double time, double *ls) {
    const rg_tables *t = &m->tables;
    double noise[RG_SENSORS];
    rg_ls(m, scenario, pose[0], pose[1], heading[0], heading[1], time, ls);
    rg_noise(seed, step, RG_NOISE_LS, noise);
    for (int k = 0; k < RG_SENSORS; k++)
        ls[k] = rg_clip(ls[k] + t->ls_noise * noise[k], 0.0, t->counts_max);
}

/* How a control step is cut: a command arrives `latency` late, so that a step has two parts. */
typedef struct {
    int whole;         /* steps that the newest command at the motors is old */
    rg_part old, rest; /* the part of the step under the command before it, and the rest */
} rg_cut;

static inline rg_cut rg_cut_of(const rg_model *m) {
    const double late = m->drive.latency / m->control_step;
    const int whole = (int)late;
    const double old = (late - whole) * m->control_step;
    return (rg_cut){whole, rg_part_of(&m->drive, old),
                    rg_part_of(&m->drive, m->control_step - old)};
}

#endif

/* One simulated robot forages (III-E): the evaluation of a controller genome. */
#include <math.h>
#include <string.h>

#include "drive.h"
#include "noise.h"
#include "random.h"
#include "realitygap_core.h"
#include "sensors.h"
#include "small.h"

typedef struct {
    double pose[3];
    double heading[2]; /* cosine and sine of yaw */
    rg_motors motors;
    rg_controller controller;
    rg_random random; /* places; the controller has its own stream, and noise goes by counter */
    double food_x[RG_FOOD_MAX], food_y[RG_FOOD_MAX];
} rg_forager;

static int rg_on_nest(const rg_model *m, double x, double y) {
    const double dx = x - m->nest_x, dy = y - m->nest_y;
    return dx * dx + dy * dy < m->nest_radius * m->nest_radius;
}

/* Uniform over the part of the arena a robot's centre can reach. */
static void rg_place(const rg_model *m, rg_random *r, double *x, double *y) {
    const double reach = m->arena_radius - m->body_radius;
    const double radius = reach * sqrt(rg_uniform(r));
    const double angle = RG_TWO_PI * rg_uniform(r);
    *x = radius * cos(angle);
    *y = radius * sin(angle);
}

/* The same, outside the nest: nobody is paid for food that lies at home. */
static void rg_place_food(const rg_model *m, rg_forager *f, int item) {
    do
        rg_place(m, &f->random, &f->food_x[item], &f->food_y[item]);
    while (rg_on_nest(m, f->food_x[item], f->food_y[item]));
}

static void rg_start(const rg_model *m, rg_forager *f, const uint32_t seed[4]) {
    memset(f, 0, sizeof *f);
    rg_seed(&f->random, seed);
    uint32_t own[4];
    for (int i = 0; i < 4; i++)
        own[i] = rg_next(&f->random);
    rg_controller_start(&f->controller, own);
    rg_place(m, &f->random, &f->pose[0], &f->pose[1]);
    f->pose[2] = RG_TWO_PI * rg_uniform(&f->random);
    f->heading[0] = cos(f->pose[2]);
    f->heading[1] = sin(f->pose[2]);
    for (int i = 0; i < m->food_items; i++)
        rg_place_food(m, f, i);
}

/* Item under the robot, or -1. */
static int rg_food_here(const rg_model *m, const rg_forager *f) {
    const double reach = m->food_radius * m->food_radius;
    int found = -1;
    for (int i = 0; i < m->food_items; i++) {
        const double dx = f->food_x[i] - f->pose[0], dy = f->food_y[i] - f->pose[1];
        if (dx * dx + dy * dy < reach)
            found = i;
    }
    return found;
}

/* Everything the controller looks at. Nobody looks at light without a gene for phototaxis in the
 * present Food state: the sensors then read dark, at no cost. */
static inline void rg_sense(const rg_model *m, const rg_forager *f, const uint32_t seed[4],
                            uint32_t step, int scenario, double *ps, double *ls) {
    const rg_tables *t = &m->tables;
    const double c = f->heading[0], s = f->heading[1];
    rg_ps(m, f->pose[0], f->pose[1], c, s, ps);
    rg_ls(m, scenario, f->pose[0], f->pose[1], c, s, f->motors.time, ls);
    double near_noise[RG_SENSORS], light_noise[RG_SENSORS];
    rg_noise(seed, step, RG_NOISE_PS, near_noise);
    rg_noise(seed, step, RG_NOISE_LS, light_noise);
    for (int k = 0; k < RG_SENSORS; k++) {
        const double near = ps[k] + (t->ps_noise[k] * ps[k] + t->ps_noise_floor) * near_noise[k];
        const double light = ls[k] + t->ls_noise * light_noise[k];
        ps[k] = rg_clip(near, 0.0, t->counts_max);
        ls[k] = rg_clip(light, 0.0, t->counts_max);
    }
}

/* Command queued `steps` control steps ago. */
static const double *rg_past(const rg_motors *motors, int steps) {
    return motors->queue[(motors->head - steps) & (RG_COMMAND_SLOTS - 1)];
}

/* Drive one control step: the command arrives `latency` late, so a step has two parts. */
static void rg_drive_step(const rg_model *m, rg_forager *f, const double command[2]) {
    const rg_drive *d = &m->drive;
    rg_motors *motors = &f->motors;
    motors->head = (motors->head + 1) & (RG_COMMAND_SLOTS - 1);
    memcpy(motors->queue[motors->head], command, sizeof motors->queue[0]);
    const double late = d->latency / m->control_step;
    const int whole = (int)late;
    const double old = (late - whole) * m->control_step; /* s of the step under the older command */
    if (old > 0.0) {
        const double *c = rg_past(motors, whole + 1);
        const double l = rg_wheel_advance(d, 0, &motors->speed[0], c[0], old, motors->time);
        const double r = rg_wheel_advance(d, 1, &motors->speed[1], c[1], old, motors->time);
        rg_arc(d, l, r, f->pose, f->heading);
    }
    const double *c = rg_past(motors, whole);
    const double rest = m->control_step - old;
    const double l = rg_wheel_advance(d, 0, &motors->speed[0], c[0], rest, motors->time);
    const double r = rg_wheel_advance(d, 1, &motors->speed[1], c[1], rest, motors->time);
    rg_arc(d, l, r, f->pose, f->heading);
    motors->time += m->control_step;
    /* the wall stops the robot where it touches: it slides along, keeping its heading */
    const double reach = m->arena_radius - m->body_radius;
    const double square = f->pose[0] * f->pose[0] + f->pose[1] * f->pose[1];
    if (square > reach * reach) {
        const double back = reach / sqrt(square);
        f->pose[0] *= back;
        f->pose[1] *= back;
    }
}

/* Is there room for food outside the nest, and for the commands on their way? */
static int rg_can_run(const rg_model *m) {
    const double reach = m->arena_radius - m->body_radius;
    const double far = sqrt(m->nest_x * m->nest_x + m->nest_y * m->nest_y) + reach;
    return m->food_items <= RG_FOOD_MAX && m->nest_radius < far &&
           m->drive.latency <= (RG_COMMAND_SLOTS - 2) * m->control_step;
}

int32_t rg_evaluate(const rg_model *m, const rg_behaviour *b, rg_trials *set, int32_t at[2]) {
    if (!rg_can_run(m))
        return RG_BAD_ARGUMENT;
    const double t_max = set->steps * m->control_step;
    for (int32_t trial = 0; trial < set->trials; trial++) {
        rg_forager f;
        const rg_behaviour *own = set->behaviours ? &set->behaviours[trial] : b;
        const int looks[2] = {rg_third(set->genomes[2 * trial]) != 1,
                              rg_third(set->genomes[2 * trial + 1]) != 1};
        rg_start(m, &f, set->seeds + 4 * trial);
        double fitness = 0.0;
        int32_t deposits = 0;
        for (int32_t step = 0; step < set->steps; step++) {
            double ps[RG_SENSORS], ls[RG_SENSORS], command[2];
            const double *genome = set->genomes + 2 * trial;
            const int32_t before = f.controller.food;
            const int item = before ? -1 : rg_food_here(m, &f);
            const int on_nest = rg_on_nest(m, f.pose[0], f.pose[1]);
            const int will_carry = before ? !on_nest : item >= 0;
            const int scenario = looks[!will_carry] ? set->scenarios[trial] : RG_DARK;
            rg_sense(m, &f, set->seeds + 4 * trial, (uint32_t)step, scenario, ps, ls);
            rg_control(own, genome, &f.controller, ps, ls, item >= 0, on_nest, command);
            if (!before && f.controller.food) {
                rg_place_food(m, &f, item);
            } else if (before && !f.controller.food) {
                fitness += t_max - step * m->control_step;
                deposits++;
            }
            rg_drive_step(m, &f, command);
            if (!isfinite(f.pose[0] + f.pose[1] + f.pose[2])) {
                at[0] = trial;
                at[1] = step;
                return RG_NOT_FINITE;
            }
        }
        set->fitness[trial] = fitness;
        set->deposits[trial] = deposits;
    }
    return RG_OK;
}

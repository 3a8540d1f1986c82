/* The four behaviours (III-F), decision by decision: the robot's controller and both forms of its
 * simulator are put together from these.
 *
 * Obstacle avoidance wins while it is committed to a turn; otherwise random search steers, and
 * phototaxis, where the gene for the present Food state asks for it and a lamp can be seen, steers
 * over it. Turns are written as a share: +1 stops the left (inner) wheel, -1 the right one, and
 * beyond 1 the inner wheel runs backwards. */
#ifndef RG_BEHAVIOUR_H
#define RG_BEHAVIOUR_H

#include <math.h>

#include "random.h"
#include "realitygap_core.h"
#include "small.h"
#include "trig.h"

/* Control steps in a time that is not negative. */
static inline int32_t rg_steps(double seconds, double step) {
    return (int32_t)(seconds / step + 0.5);
}

/* Control steps of the times that avoidance keeps. */
typedef struct {
    int32_t memory; /* after a turn */
    int32_t turn;   /* the turn itself and its memory */
} rg_pace;

static inline rg_pace rg_pace_of(const rg_behaviour *b) {
    const int32_t memory = rg_steps(b->avoid_memory, b->control_step);
    return (rg_pace){memory, memory + rg_steps(b->avoid_duration, b->control_step)};
}

/* Carry state from the virtual sensor: food is picked up where it lies, dropped only on the nest.
 */
static inline void rg_handle_food(rg_controller *c, int32_t on_food, int32_t on_nest) {
    if (c->food)
        c->food = !on_nest;
    else
        c->food = on_food != 0;
}

/* The side of an obstacle, by the strongest reading on each side in thresholds: +1 nearer on the
 * right, -1 not nearer on the right, 0 none. */
static inline int32_t rg_obstacle(double right, double left) {
    if (rg_max(right, left) < 1.0)
        return 0;
    return right > left ? 1 : -1;
}

/* A seen obstacle commits the robot to a turn away from the nearer side. One met again soon after
 * is turned from the same way, or robots in a crowd swing to and fro and jam. avoid_steps counts
 * down through the turn and on through that memory, which ends at zero. Obstacles are looked for
 * while avoid_steps is within the memory. */
static inline int rg_turns_away(const rg_pace *pace, rg_controller *c, int32_t obstacle) {
    if (obstacle != 0) {
        if (c->avoid_steps == 0)
            c->avoid_direction = obstacle;
        c->avoid_steps = pace->turn;
    }
    const int turning = c->avoid_steps > pace->memory;
    c->avoid_steps -= c->avoid_steps > 0;
    return turning;
}

/* Random search: stretches of random length and curvature. */
static inline double rg_search(const rg_behaviour *b, rg_controller *c) {
    if (c->search_steps == 0) {
        const double span = b->search_duration[1] - b->search_duration[0];
        const double seconds = b->search_duration[0] + span * rg_uniform(&c->random);
        c->search_steps = rg_steps(seconds, b->control_step);
        c->search_turn = b->search_curvature * (2.0 * rg_uniform(&c->random) - 1.0);
    }
    c->search_steps--;
    return c->search_turn;
}

/* Sum of eight, by halves. */
#define RG_SUM(x) (((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7])))

/* Bearing of the light (rad from forward) from the sensors' readings, or 0 and *seen = 0. */
static inline double rg_light_bearing(const rg_behaviour *b, const double *ls, int *seen) {
    double dark = ls[0], bright = ls[0];
    for (int k = 1; k < RG_SENSORS; k++) {
        dark = rg_max(dark, ls[k]);
        bright = rg_min(bright, ls[k]);
    }
    *seen = dark - bright >= b->light_contrast;
    if (!*seen)
        return 0.0;
    double forward[RG_SENSORS], leftward[RG_SENSORS];
    for (int k = 0; k < RG_SENSORS; k++) {
        forward[k] = (dark - ls[k]) * b->sensor_cos[k];
        leftward[k] = (dark - ls[k]) * b->sensor_sin[k];
    }
    return rg_angle(RG_SUM(leftward), RG_SUM(forward));
}

/* Search's turn, with that of phototaxis (taxis -1, +1) over it where a light is seen. */
static inline double rg_follow(const rg_behaviour *b, int32_t taxis, const double *ls,
                               double turn) {
    int seen;
    double bearing = rg_light_bearing(b, ls, &seen);
    if (!seen)
        return turn;
    if (taxis < 0)
        bearing -= copysign(RG_PI, bearing);
    turn = rg_clip(b->light_gain * bearing, -2.0, 2.0) + b->light_search * turn;
    return rg_clip(turn, -2.0, 2.0);
}

/* Wheel speeds (rad/s) of a turn away, or of a turn's share. */
static inline void rg_spin(const rg_behaviour *b, const rg_controller *c, double *command) {
    command[0] = -c->avoid_direction * b->avoid_speed;
    command[1] = c->avoid_direction * b->avoid_speed;
}
static inline void rg_steer(const rg_behaviour *b, double turn, double *command) {
    const double inner = b->cruise_speed * (1.0 - fabs(turn));
    command[0] = turn > 0.0 ? inner : b->cruise_speed;
    command[1] = turn > 0.0 ? b->cruise_speed : inner;
}

#endif

/* The four behaviours (III-F) as one function, run unchanged by the robot and by its simulator.
 *
 * Obstacle avoidance wins while it is committed to a turn; otherwise random search steers, and
 * phototaxis, where the gene for the present Food state asks for it and a lamp can be seen, steers
 * over it. Turns are written as a share: +1 stops the left (inner) wheel, -1 the right one, and
 * beyond 1 the inner wheel runs backwards. */
#include <math.h>

#include "random.h"
#include "realitygap_core.h"
#include "small.h"
#include "trig.h"

int32_t rg_third(double gene) { return gene < 0.33 ? 0 : gene < 0.66 ? 1 : 2; }

void rg_controller_start(rg_controller *c, const uint32_t seed[4]) {
    rg_seed(&c->random, seed);
    c->food = 0;
    c->avoid_steps = 0;
    c->avoid_direction = 1;
    c->search_steps = 0;
    c->search_turn = 0.0;
}

/* Carry state from the virtual sensor: food is picked up where it lies, dropped only on the nest.
 */
static void rg_handle_food(rg_controller *c, int32_t on_food, int32_t on_nest) {
    if (c->food)
        c->food = !on_nest;
    else
        c->food = on_food != 0;
}

/* Look for an obstacle ahead; a seen one commits the robot to a turn away from the nearer side. One
 * met again soon after is turned from the same way, or robots in a crowd swing to and fro and jam.
 * avoid_steps counts down through the turn and on through that memory, which ends at zero. */
static int rg_turns_away(const rg_behaviour *b, rg_controller *c, const double *ps) {
    const int32_t memory = (int32_t)lround(b->avoid_memory / b->control_step);
    if (c->avoid_steps <= memory) {
        double right = 0.0, left = 0.0; /* strongest reading on each side, in thresholds */
        for (int k = 0; k < 4; k++) {
            right = rg_max(right, ps[k] / b->avoid_threshold[k]);
            left = rg_max(left, ps[7 - k] / b->avoid_threshold[7 - k]);
        }
        if (rg_max(right, left) >= 1.0) {
            if (c->avoid_steps == 0)
                c->avoid_direction = right > left ? 1 : -1;
            c->avoid_steps = memory + (int32_t)lround(b->avoid_duration / b->control_step);
        }
    }
    const int turning = c->avoid_steps > memory;
    c->avoid_steps -= c->avoid_steps > 0;
    return turning;
}

/* Random search: stretches of random length and curvature. */
static double rg_search(const rg_behaviour *b, rg_controller *c) {
    if (c->search_steps == 0) {
        const double span = b->search_duration[1] - b->search_duration[0];
        const double seconds = b->search_duration[0] + span * rg_uniform(&c->random);
        c->search_steps = (int32_t)lround(seconds / b->control_step);
        c->search_turn = b->search_curvature * (2.0 * rg_uniform(&c->random) - 1.0);
    }
    c->search_steps--;
    return c->search_turn;
}

/* Sum of eight, by halves. */
static double rg_sum(const double *x) {
    return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

/* Bearing of the light (rad from forward) from the sensors' readings, or 0 and *seen = 0. */
static double rg_light_bearing(const rg_behaviour *b, const double *ls, int *seen) {
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
    return rg_angle(rg_sum(leftward), rg_sum(forward));
}

void rg_control(const rg_behaviour *b, const double genome[2], rg_controller *c, const double *ps,
                const double *ls, int32_t on_food, int32_t on_nest, double *command) {
    rg_handle_food(c, on_food, on_nest);
    double turn = rg_search(b, c);
    if (rg_turns_away(b, c, ps)) {
        command[0] = -c->avoid_direction * b->avoid_speed;
        command[1] = c->avoid_direction * b->avoid_speed;
        return;
    }
    const int32_t taxis = rg_third(c->food ? genome[0] : genome[1]) - 1; /* -1, 0, +1 */
    if (taxis != 0) {
        int seen;
        double bearing = rg_light_bearing(b, ls, &seen);
        if (seen) {
            if (taxis < 0)
                bearing -= copysign(0.5 * 6.28318530717958647692, bearing);
            turn = rg_clip(b->light_gain * bearing, -2.0, 2.0) + b->light_search * turn;
            turn = rg_clip(turn, -2.0, 2.0);
        }
    }
    const double inner = b->cruise_speed * (1.0 - fabs(turn));
    command[0] = turn > 0.0 ? inner : b->cruise_speed;
    command[1] = turn > 0.0 ? b->cruise_speed : inner;
}

void rg_control_swarm(const rg_behaviour *behaviours, int32_t robots, const uint8_t *active,
                      const double *genomes, rg_controller *controllers, const double *ps,
                      const double *ls, const uint8_t *on_food, const uint8_t *on_nest,
                      double *commands, uint8_t *picked, uint8_t *dropped) {
    for (int32_t i = 0; i < robots; i++) {
        picked[i] = dropped[i] = 0;
        commands[2 * i] = commands[2 * i + 1] = 0.0;
        if (!active[i])
            continue;
        rg_controller *c = &controllers[i];
        const int32_t before = c->food;
        rg_control(&behaviours[i], genomes + 2 * i, c, ps + RG_SENSORS * i, ls + RG_SENSORS * i,
                   on_food[i], on_nest[i], commands + 2 * i);
        picked[i] = (uint8_t)(!before && c->food);
        dropped[i] = (uint8_t)(before && !c->food);
    }
}

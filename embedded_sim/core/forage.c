/* The evaluation of controller genomes: trials one after the other, and how they share lanes. */
#include <math.h>
#include <string.h>

#include "batch.h"
#include "check.h"
#include "drive.h"
#include "laws.h"
#include "realitygap_core.h"
#include "trial.h"

typedef struct {
    rg_beginning now; /* pose, controller and streams as they are, from the beginning on */
    rg_motors motors;
    double food_x[RG_FOOD_MAX], food_y[RG_FOOD_MAX];
    double clear; /* m that can be driven before any food is under the robot */
} rg_forager;

/* Item under the robot, or -1. */
static int rg_food_here(const rg_model *m, rg_forager *f) {
    if (f->clear > 0.0)
        return -1;
    const double reach = m->food_radius * m->food_radius;
    double nearest = INFINITY;
    int found = -1;
    for (int i = 0; i < m->food_items; i++) {
        const double dx = f->food_x[i] - f->now.pose[0], dy = f->food_y[i] - f->now.pose[1];
        const double square = dx * dx + dy * dy;
        nearest = rg_min(nearest, square);
        if (square < reach)
            found = i;
    }
    f->clear = sqrt(nearest) - m->food_radius - RG_MARGIN;
    return found;
}

/* Command queued `steps` control steps ago. */
static const double *rg_past(const rg_motors *motors, int steps) {
    return motors->queue[(motors->head - steps) & (RG_COMMAND_SLOTS - 1)];
}

/* Drive a part of a step under one command. */
static void rg_drive_part(const rg_drive *d, rg_forager *f, const double *command,
                          const rg_part *part) {
    rg_motors *motors = &f->motors;
    double turned[2];
    rg_wheels_advance(d, &motors->wheels, command, part, motors->time, turned);
    const double l = turned[0], r = turned[1];
    if (d->laws == 0) {
        f->clear -= rg_arc(d, l, r, f->now.pose, f->now.heading);
        return;
    }
    const double *pose = f->now.pose, *heading = f->now.heading;
    const rg_place_of at = {pose[0], pose[1], heading[0], heading[1], INFINITY, motors->time};
    const rg_moved moved = rg_obey(d, &at, part->h, l, r);
    f->clear -= rg_arc_of(&moved, f->now.pose, f->now.heading);
}

static void rg_drive_step(const rg_model *m, const rg_cut *cut, rg_forager *f,
                          const double command[2]) {
    const rg_drive *d = &m->drive;
    rg_motors *motors = &f->motors;
    motors->head = (motors->head + 1) & (RG_COMMAND_SLOTS - 1);
    memcpy(motors->queue[motors->head], command, sizeof motors->queue[0]);
    if (cut->old.h > 0.0)
        rg_drive_part(d, f, rg_past(motors, cut->whole + 1), &cut->old);
    rg_drive_part(d, f, rg_past(motors, cut->whole), &cut->rest);
    motors->time += m->control_step;
    /* the wall stops the robot where it touches: it slides along, keeping its heading */
    const double reach = m->arena_radius - m->body_radius;
    const double square = f->now.pose[0] * f->now.pose[0] + f->now.pose[1] * f->now.pose[1];
    if (square > reach * reach) {
        const double back = reach / sqrt(square);
        f->now.pose[0] *= back;
        f->now.pose[1] *= back;
    }
}

/* What the robot does now: the decisions of rg_control, from what it senses here. */
static void rg_decide(const rg_model *m, const rg_behaviour *b, const rg_watch *w, rg_forager *f,
                      const uint32_t seed[4], uint32_t step, int32_t scenario, double *command) {
    rg_controller *c = &f->now.controller;
    double turn = rg_search(b, c);
    int32_t obstacle = 0;
    if (c->avoid_steps <= w->pace.memory &&
        f->now.pose[0] * f->now.pose[0] + f->now.pose[1] * f->now.pose[1] >= w->near_square)
        obstacle = rg_look_ahead(m, b, w, seed, step, f->now.pose, f->now.heading);
    if (rg_turns_away(&w->pace, c, obstacle)) {
        rg_spin(b, c, command);
        return;
    }
    const int32_t taxis = w->taxis[c->food];
    if (taxis != 0) {
        double ls[RG_SENSORS];
        rg_see_light(m, seed, step, scenario, f->now.pose, f->now.heading, f->motors.time, ls);
        turn = rg_follow(b, taxis, ls, turn);
    }
    rg_steer(b, turn, command);
}

/* One trial. *at holds the step at which one ended that could not go on. */
static int32_t rg_forage(const rg_model *m, const rg_behaviour *b, rg_trials *set, int32_t trial,
                         int32_t *at) {
    const uint32_t *seed = set->seeds + 4 * trial;
    const int32_t scenario = set->scenarios[trial];
    const rg_watch watch = rg_watch_of(m, b, set->genomes + 2 * trial, scenario);
    const rg_cut cut = rg_cut_of(m);
    const double t_max = set->steps * m->control_step;
    rg_forager f;
    memset(&f, 0, sizeof f);
    *at = 0;
    if (!rg_begin(m, seed, &f.now, f.food_x, f.food_y))
        return RG_NO_ROOM;
    double fitness = 0.0;
    int32_t deposits = 0;
    for (int32_t step = 0; step < set->steps; step++) {
        *at = step;
        const int32_t before = f.now.controller.food;
        const int item = before ? -1 : rg_food_here(m, &f);
        const int on_nest = before && rg_on_nest(m, f.now.pose[0], f.now.pose[1]);
        rg_handle_food(&f.now.controller, item >= 0, on_nest);
        if (item >= 0) {
            if (!rg_place_food(m, &f.now.random, &f.food_x[item], &f.food_y[item]))
                return RG_NO_ROOM;
            f.clear = 0.0;
        } else if (on_nest) {
            fitness += t_max - step * m->control_step;
            deposits++;
        }
        double command[2];
        rg_decide(m, b, &watch, &f, seed, (uint32_t)step, scenario, command);
        rg_drive_step(m, &cut, &f, command);
        if (!isfinite(f.now.pose[0] + f.now.pose[1] + f.now.heading[0] + f.now.heading[1]))
            return RG_NOT_FINITE;
    }
    set->fitness[trial] = fitness;
    set->deposits[trial] = deposits;
    return RG_OK;
}

/* Do trials look at light without food, with food, and is the captured lamp lit? Those of one kind
 * share lanes: a lane that looks makes its neighbours wait. */
static int rg_kind(const rg_model *m, const rg_trials *set, int32_t trial) {
    const double *genome = set->genomes + 2 * trial;
    if (!m->lamp_on[set->scenarios[trial]] && m->second_gain <= 0.0)
        return 0;
    return 4 * (m->lamp_on[set->scenarios[trial]] != 0) + (rg_third(genome[0]) != 1) +
           2 * (rg_third(genome[1]) != 1);
}

/* All trials in lanes; false: some could not go on. */
static int rg_side_by_side(const rg_model *m, const rg_behaviour *b, rg_trials *set) {
    int32_t group[RG_TOGETHER];
    int filled = 0;
    for (int kind = 0; kind < 8; kind++)
        for (int32_t trial = 0; trial < set->trials; trial++) {
            if (rg_kind(m, set, trial) != kind)
                continue;
            group[filled++] = trial;
            if (filled == RG_TOGETHER && !rg_forage_lanes(m, b, set, group, filled))
                return 0;
            filled %= RG_TOGETHER;
        }
    return filled == 0 || rg_forage_lanes(m, b, set, group, filled);
}

static int rg_check_trials(rg_refusal *why, const rg_trials *set) {
    if (!(rg_within(why, "steps", -1, set->steps, 0.0, RG_STEPS_MAX) &&
          rg_within(why, "trials", -1, set->trials, 0.0, RG_MANY) &&
          rg_within(why, "form", -1, set->form, RG_BEST, RG_AVX512) &&
          rg_there(why, "genomes", set->genomes, set->trials) &&
          rg_there(why, "scenarios", set->scenarios, set->trials) &&
          rg_there(why, "seeds", set->seeds, set->trials) &&
          rg_there(why, "fitness", set->fitness, set->trials) &&
          rg_there(why, "deposits", set->deposits, set->trials)))
        return 0;
    for (int32_t i = 0; i < set->trials; i++)
        if (!(rg_within(why, "genomes", i, set->genomes[2 * i], RG_ANY) &&
              rg_within(why, "genomes", i, set->genomes[2 * i + 1], RG_ANY) &&
              rg_within(why, "scenarios", i, set->scenarios[i], 0.0, RG_SCENARIOS - 1) &&
              (set->behaviours == NULL || rg_check_behaviour(&set->behaviours[i], why) == RG_OK)))
            return 0;
    return 1;
}

int32_t rg_evaluate(const rg_model *m, const rg_behaviour *b, rg_trials *set, rg_refusal *why) {
    if (rg_check_model(m, why) != RG_OK || rg_check_behaviour(b, why) != RG_OK ||
        !rg_check_trials(why, set))
        return RG_BAD_ARGUMENT;
    if (!rg_has_form(set->form)) {
        *why = (rg_refusal){"form", -1, 0, set->form, RG_BEST, RG_ONE_BY_ONE};
        return RG_BAD_ARGUMENT;
    }
    if (set->trials > 1 && set->form != RG_ONE_BY_ONE && rg_side_by_side(m, b, set))
        return RG_OK;
    /* also to say which trial could not go on, and when */
    for (int32_t trial = 0; trial < set->trials; trial++) {
        const rg_behaviour *own = set->behaviours ? &set->behaviours[trial] : b;
        int32_t step;
        const int32_t status = rg_forage(m, own, set, trial, &step);
        if (status != RG_OK) {
            *why = (rg_refusal){"trial", trial, step, NAN, -DBL_MAX, DBL_MAX};
            return status;
        }
    }
    return RG_OK;
}

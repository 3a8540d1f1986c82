/* Trials side by side: what each lane holds, and how a trial enters one. */
#ifndef RG_GROUP_STATE_H
#define RG_GROUP_STATE_H

#include "batch.h"
#include "lanes.h"
#include "trial.h"

typedef struct {
    rg_v x, y, cosine, sine; /* pose; cosine and sine of yaw */
    rg_v speed[2], asked[2];
    rg_v queue[RG_COMMAND_SLOTS][2];
    rg_v food_x[RG_FOOD_MAX], food_y[RG_FOOD_MAX];
    rg_v search_turn, avoid_direction;
    rg_m search_steps, avoid_steps, food; /* food: mask */
    /* of each lane's controller, model and stream, which stay */
    rg_v cruise_speed, avoid_speed, light_contrast, light_gain, light_search;
    rg_v ray[RG_SENSORS]; /* m from the centre to where a sensor's reach ends */
    rg_v lamp_x, lamp_y, lamp_on;
    uint64_t watched; /* sensors with a reach, as bits */
    rg_m memory, turn, taxis[2];
    rg_u seed[4];
    rg_random random[RG_LANES];
    rg_controller search[RG_LANES]; /* of these only what draws a stretch of search is used */
    rg_watch watch[RG_LANES];
    const rg_behaviour *behaviour[RG_LANES];
    const uint32_t *words[RG_LANES];
    rg_v fitness;
    int32_t deposits[RG_LANES];
} rg_group;

/* Of trials as bits, those of group i. */
RG_INLINE uint64_t rg_group_of(uint64_t trials, int i) {
    return trials >> i * RG_LANES & ((1u << RG_LANES) - 1);
}

/* False: there is no room for its food. */
static int rg_join(rg_group *g, int l, const rg_model *m, const rg_behaviour *b,
                   const rg_trials *set, int32_t trial) {
    const uint32_t *seed = set->seeds + 4 * trial;
    const int32_t scenario = set->scenarios[trial];
    rg_beginning start;
    double food_x[RG_FOOD_MAX], food_y[RG_FOOD_MAX];
    if (!rg_begin(m, seed, &start, food_x, food_y))
        return 0;
    g->random[l] = start.random;
    g->search[l] = start.controller;
    g->x[l] = start.pose[0];
    g->y[l] = start.pose[1];
    g->cosine[l] = start.heading[0];
    g->sine[l] = start.heading[1];
    for (int i = 0; i < m->food_items; i++) {
        g->food_x[i][l] = food_x[i];
        g->food_y[i][l] = food_y[i];
    }
    g->avoid_direction[l] = start.controller.avoid_direction;
    g->watch[l] = rg_watch_of(m, b, set->genomes + 2 * trial, scenario);
    g->behaviour[l] = b;
    g->words[l] = seed;
    for (int i = 0; i < 4; i++)
        g->seed[i][l] = seed[i];
    g->cruise_speed[l] = b->cruise_speed;
    g->avoid_speed[l] = b->avoid_speed;
    g->light_contrast[l] = b->light_contrast;
    g->light_gain[l] = b->light_gain;
    g->light_search[l] = b->light_search;
    for (int k = 0; k < RG_SENSORS; k++) {
        const double reach = g->watch[l].reach[k];
        g->ray[k][l] = reach > 0.0 ? m->body_radius + reach : 0.0;
        g->watched |= (uint64_t)(reach > 0.0) << k;
    }
    g->memory[l] = g->watch[l].pace.memory;
    g->turn[l] = g->watch[l].pace.turn;
    for (int food = 0; food < 2; food++)
        g->taxis[food][l] = g->watch[l].taxis[food];
    g->lamp_x[l] = m->lamp_x[scenario];
    g->lamp_y[l] = m->lamp_y[scenario];
    g->lamp_on[l] = m->lamp_on[scenario] != 0;
    return 1;
}

#endif

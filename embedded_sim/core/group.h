/* The evaluation of controller genomes, trials side by side in SIMD lanes: step by step what
 * forage.c does with one, and the same bits. What few lanes need at a time, they do one by one.
 * Included once for each instruction set, which says what RG_FORAGE_LANES is called there. */

#include <string.h>

#include "group_drive.h"
#include "group_light.h"
#include "group_obstacle.h"

/* Food is picked up, replaced and deposited. False: there is no room for it. */
RG_INLINE int rg_handle_food_v(const rg_model *m, rg_group *g, double worth) {
    const double reach = m->food_radius * m->food_radius;
    rg_m found = (rg_m){0} - 1;
    for (int i = 0; i < m->food_items; i++) {
        const rg_v dx = g->food_x[i] - g->x, dy = g->food_y[i] - g->y;
        found = rg_pick_m(dx * dx + dy * dy < reach, (rg_m){0} + i, found);
    }
    const rg_v nx = g->x - m->nest_x, ny = g->y - m->nest_y;
    const rg_m picked = ~g->food & (found >= 0);
    const rg_m dropped = g->food & (nx * nx + ny * ny < m->nest_radius * m->nest_radius);
    g->food ^= picked | dropped;
    RG_EACH(l, rg_which(picked)) {
        double x, y;
        if (!rg_place_food(m, &g->random[l], &x, &y))
            return 0;
        g->food_x[found[l]][l] = x;
        g->food_y[found[l]][l] = y;
    }
    RG_EACH(l, rg_which(dropped)) {
        g->fitness[l] += worth;
        g->deposits[l]++;
    }
    return 1;
}

/* Curvature of search: rg_search, where a stretch ends. */
RG_INLINE rg_v rg_search_v(rg_group *g) {
    RG_EACH(l, rg_which(g->search_steps == 0)) {
        g->search[l].search_steps = 0;
        g->search_turn = rg_put_v(g->search_turn, l, rg_search(g->behaviour[l], &g->search[l]));
        g->search_steps = rg_put_m(g->search_steps, l, g->search[l].search_steps + 1);
    }
    g->search_steps -= 1;
    return g->search_turn;
}

/* rg_turns_away, from obstacles on the right and on the left of lanes, as bits */
RG_INLINE rg_m rg_turns_away_v(rg_group *g, uint64_t right, uint64_t left) {
    const rg_m met = rg_mask_v(right | left);
    const rg_v side = rg_pick(rg_mask_v(right), rg_all(1.0), rg_all(-1.0));
    g->avoid_direction = rg_pick(met & (g->avoid_steps == 0), side, g->avoid_direction);
    g->avoid_steps = rg_pick_m(met, g->turn, g->avoid_steps);
    const rg_m turning = g->avoid_steps > g->memory;
    g->avoid_steps += g->avoid_steps > 0;
    return turning;
}

/* The decisions of rg_control, from what each lane senses: wheel speeds. */
RG_INLINE void rg_decide_v(const rg_model *m, rg_group *g, int n, uint32_t step, double time,
                           rg_v (*command)[2]) {
    rg_m turning[RG_GROUPS], taxis[RG_GROUPS];
    rg_v turn[RG_GROUPS];
    uint64_t right, left; /* trials with an obstacle there */
    rg_obstacles_v(m, g, n, step, &right, &left);
    for (int i = 0; i < n; i++) {
        turning[i] = rg_turns_away_v(&g[i], rg_group_of(right, i), rg_group_of(left, i));
        taxis[i] = rg_pick_m(g[i].food, g[i].taxis[1], g[i].taxis[0]) & ~turning[i];
        turn[i] = rg_search_v(&g[i]);
    }
    rg_light_v(m, g, n, step, time, taxis, turn);
    for (int i = 0; i < n; i++) {
        const rg_v cruise = g[i].cruise_speed, inner = cruise * (1.0 - rg_abs_v(turn[i]));
        const rg_v spin = g[i].avoid_direction * g[i].avoid_speed;
        const rg_m slow_left = turn[i] > 0.0;
        command[i][0] = rg_pick(turning[i], -spin, rg_pick(slow_left, inner, cruise));
        command[i][1] = rg_pick(turning[i], spin, rg_pick(slow_left, cruise, inner));
    }
}

/* Runs n groups, whose instructions overlap; whether all could go on. */
static int rg_run(const rg_model *m, rg_group *g, int n, int32_t steps) {
    const rg_cut cut = rg_cut_of(m);
    const double t_max = steps * m->control_step;
    double time = 0.0;
    for (int32_t step = 0; step < steps; step++) {
        rg_v command[RG_GROUPS][2];
        for (int i = 0; i < n; i++)
            if (!rg_handle_food_v(m, &g[i], t_max - step * m->control_step))
                return 0;
        rg_decide_v(m, g, n, (uint32_t)step, time, command);
        rg_drive_step_v(m, &cut, g, n, step, time, command);
        rg_m wrong = {0};
        for (int i = 0; i < n; i++) {
            const rg_v sum = g[i].x + g[i].y + g[i].cosine + g[i].sine;
            wrong |= sum - sum != 0.0;
        }
        time += m->control_step;
        if (rg_which(wrong) != 0)
            return 0;
    }
    return 1;
}

int RG_FORAGE_LANES(const rg_model *m, const rg_behaviour *b, rg_trials *set, const int32_t *trials,
                    int count) {
    rg_group groups[RG_GROUPS];
    memset(groups, 0, sizeof groups);
    const int n = (count + RG_LANES - 1) / RG_LANES;
    for (int l = 0; l < n * RG_LANES; l++) {
        const int32_t trial = trials[l < count ? l : 0]; /* lanes left over repeat a trial */
        const rg_behaviour *own = set->behaviours ? &set->behaviours[trial] : b;
        if (!rg_join(&groups[l / RG_LANES], l % RG_LANES, m, own, set, trial))
            return 0;
    }
    if (!rg_run(m, groups, n, set->steps))
        return 0;
    for (int i = 0; i < count; i++) {
        set->fitness[trials[i]] = groups[i / RG_LANES].fitness[i % RG_LANES];
        set->deposits[trials[i]] = groups[i / RG_LANES].deposits[i % RG_LANES];
    }
    return 1;
}

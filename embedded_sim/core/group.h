/* The evaluation of controller genomes, trials side by side in SIMD lanes: step by step what
 * forage.c does with one, and the same bits. What few lanes need at a time, they do one by one.
 * Included once for each instruction set, which says what RG_FORAGE_LANES is called there. */

#include <math.h>
#include <string.h>

#include "batch.h"
#include "lanes.h"
#include "trial.h"

typedef struct {
    rg_v x, y, cosine, sine; /* pose; cosine and sine of yaw */
    rg_v speed[2];
    rg_v queue[RG_COMMAND_SLOTS][2];
    rg_v food_x[RG_FOOD_MAX], food_y[RG_FOOD_MAX];
    rg_v search_turn, avoid_direction;
    rg_m search_steps, avoid_steps, food; /* food: mask */
    /* of each lane's controller, model and stream, which stay */
    rg_v cruise_speed, avoid_speed, light_contrast, light_gain, light_search;
    rg_v near_square, lamp_x, lamp_y, lamp_on;
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

static void rg_join(rg_group *g, int l, const rg_model *m, const rg_behaviour *b,
                    const rg_trials *set, int32_t trial) {
    const uint32_t *seed = set->seeds + 4 * trial;
    const int32_t scenario = set->scenarios[trial];
    rg_beginning start;
    double food_x[RG_FOOD_MAX], food_y[RG_FOOD_MAX];
    rg_begin(m, seed, &start, food_x, food_y);
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
    g->near_square[l] = g->watch[l].near_square;
    g->memory[l] = g->watch[l].pace.memory;
    g->turn[l] = g->watch[l].pace.turn;
    for (int food = 0; food < 2; food++)
        g->taxis[food][l] = g->watch[l].taxis[food];
    g->lamp_x[l] = m->lamp_x[scenario];
    g->lamp_y[l] = m->lamp_y[scenario];
    g->lamp_on[l] = m->lamp_on[scenario] != 0;
}

/* Food is picked up, replaced and deposited. */
RG_INLINE void rg_handle_food_v(const rg_model *m, rg_group *g, double worth) {
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
        rg_place_food(m, &g->random[l], &x, &y);
        g->food_x[found[l]][l] = x;
        g->food_y[found[l]][l] = y;
    }
    RG_EACH(l, rg_which(dropped)) {
        g->fitness[l] += worth;
        g->deposits[l]++;
    }
}

/* Do any lanes of group i look at light? */
#define RG_EACH_LOOKING(i, looks)                                                                  \
    for (int i = 0; i < RG_GROUPS; i++)                                                            \
        if (looks[i])

/* Counts below dark that a lamp takes off the light sensors; gain 0 leaves their bits. What groups
 * do is told alternately here and in rg_follow_v, so that one can go on while the other waits. */
RG_INLINE void rg_lamp_v(const rg_model *m, const rg_group *g, const int *looks, const rg_v *x,
                         const rg_v *y, const rg_v *gain, rg_v (*ls)[RG_SENSORS]) {
    const rg_tables *t = &m->tables;
    const int around = 3 * t->ls_bearings + 1;
    const double per_rad = t->ls_bearings / RG_TWO_PI;
    rg_v bearing[RG_GROUPS] = {{0}}, wd[RG_GROUPS] = {{0}};
    rg_m row[RG_GROUPS] = {{0}};
    RG_EACH_LOOKING(i, looks) {
        const rg_v dx = x[i] - g[i].x, dy = y[i] - g[i].y, c = g[i].cosine, s = g[i].sine;
        bearing[i] = rg_clip_v(rg_angle_v(c * dy - s * dx, c * dx + s * dy), -RG_PI, RG_PI);
        const rg_v u = rg_sqrt_v(rg_sqrt_v(dx * dx + dy * dy) / t->ls_range);
        row[i] = rg_node_v(u, t->ls_distances, &wd[i]) * around;
    }
    for (int k = 0; k < RG_SENSORS; k++)
        RG_EACH_LOOKING(i, looks) {
            const rg_v at = (bearing[i] - m->sensor_angle[k] + 1.5 * RG_TWO_PI) * per_rad;
            const rg_m j = rg_whole_v(at);
            const rg_v wb = at - rg_number_v(j), no_wb = 1.0 - wb;
            const rg_u low = rg_pairs_v(t->ls_counts, row[i] + j);
            const rg_u high = rg_pairs_v(t->ls_counts + around, row[i] + j);
            const rg_v lit =
                (1.0 - wd[i]) * (no_wb * rg_first_v(low) + wb * rg_first_v(low >> 32)) +
                wd[i] * (no_wb * rg_first_v(high) + wb * rg_first_v(high >> 32));
            ls[i][k] -= m->ls_gain[k] * gain[i] * lit;
        }
}

/* Largest or smallest of eight. */
#define RG_MOST(pick, x)                                                                           \
    pick(pick(pick(x[0], x[1]), pick(x[2], x[3])), pick(pick(x[4], x[5]), pick(x[6], x[7])))

/* Phototaxis over search's turn, where a lane follows light (taxis) and sees it. */
RG_INLINE void rg_follow_v(const rg_model *m, const rg_group *g, uint32_t step, double time,
                           const rg_m *taxis, rg_v *turn) {
    const rg_tables *t = &m->tables;
    const rg_behaviour *b = g[0].behaviour[0]; /* where the sensors are is the same for all */
    const double power = m->lamp_gain * rg_max(1.0 - m->lamp_decay * time, 0.0);
    int looks[RG_GROUPS];
    rg_v ls[RG_GROUPS][RG_SENSORS], noise[RG_GROUPS][RG_SENSORS], seen[RG_GROUPS] = {{0}};
    rg_v x[RG_GROUPS], y[RG_GROUPS], gain[RG_GROUPS], bearing[RG_GROUPS] = {{0}};
    for (int i = 0; i < RG_GROUPS; i++) {
        looks[i] = rg_which(taxis[i] != 0) != 0;
        x[i] = g[i].lamp_x;
        y[i] = g[i].lamp_y;
        gain[i] = power * g[i].lamp_on;
        for (int k = 0; k < RG_SENSORS; k++)
            ls[i][k] = rg_all(t->ls_dark[k]);
    }
    rg_lamp_v(m, g, looks, x, y, gain, ls);
    if (m->second_gain > 0.0) {
        for (int i = 0; i < RG_GROUPS; i++) {
            x[i] = rg_all(m->second_x);
            y[i] = rg_all(m->second_y);
            gain[i] = rg_all(m->second_gain);
        }
        rg_lamp_v(m, g, looks, x, y, gain, ls);
    }
    RG_EACH_LOOKING(i, looks)
    rg_noise_v(g[i].seed, step, RG_NOISE_LS, noise[i]);
    RG_EACH_LOOKING(i, looks) {
        rg_v forward[RG_SENSORS], leftward[RG_SENSORS];
        for (int k = 0; k < RG_SENSORS; k++) {
            const rg_v clean = rg_max_v(ls[i][k], (rg_v){0});
            ls[i][k] = rg_clip_v(clean + t->ls_noise * noise[i][k], 0.0, t->counts_max);
        }
        const rg_v dark = RG_MOST(rg_max_v, ls[i]);
        seen[i] = dark - RG_MOST(rg_min_v, ls[i]);
        for (int k = 0; k < RG_SENSORS; k++) {
            forward[k] = (dark - ls[i][k]) * b->sensor_cos[k];
            leftward[k] = (dark - ls[i][k]) * b->sensor_sin[k];
        }
        x[i] = RG_SUM(forward);
        y[i] = RG_SUM(leftward);
    }
    RG_EACH_LOOKING(i, looks)
    bearing[i] = rg_angle_v(y[i], x[i]);
    RG_EACH_LOOKING(i, looks) {
        const rg_v back = bearing[i] - rg_sign_v(rg_all(RG_PI), bearing[i]);
        const rg_v towards = rg_pick(taxis[i] < 0, back, bearing[i]);
        const rg_v follow = rg_clip_v(g[i].light_gain * towards, -2.0, 2.0);
        const rg_v both = rg_clip_v(follow + g[i].light_search * turn[i], -2.0, 2.0);
        turn[i] = rg_pick((taxis[i] != 0) & (seen[i] >= g[i].light_contrast), both, turn[i]);
    }
}

/* Search, and the turns away from obstacles: what rg_control does before it looks at light. */
RG_INLINE rg_m rg_avoid_v(const rg_model *m, rg_group *g, uint32_t step) {
    RG_EACH(l, rg_which(g->search_steps == 0)) {
        g->search[l].search_steps = 0;
        g->search_turn[l] = rg_search(g->behaviour[l], &g->search[l]);
        g->search_steps[l] = g->search[l].search_steps + 1;
    }
    g->search_steps -= 1;
    const rg_m near = g->x * g->x + g->y * g->y >= g->near_square;
    RG_EACH(l, rg_which((g->avoid_steps <= g->memory) & near)) {
        const double pose[2] = {g->x[l], g->y[l]}, heading[2] = {g->cosine[l], g->sine[l]};
        const int32_t obstacle =
            rg_look_ahead(m, g->behaviour[l], &g->watch[l], g->words[l], step, pose, heading);
        if (obstacle != 0) {
            if (g->avoid_steps[l] == 0)
                g->avoid_direction[l] = obstacle;
            g->avoid_steps[l] = g->turn[l];
        }
    }
    const rg_m turning = g->avoid_steps > g->memory;
    g->avoid_steps += g->avoid_steps > 0;
    return turning;
}

/* The decisions of rg_control, from what each lane senses: wheel speeds. */
RG_INLINE void rg_decide_v(const rg_model *m, rg_group *g, uint32_t step, double time,
                           rg_v (*command)[2]) {
    rg_m turning[RG_GROUPS], taxis[RG_GROUPS];
    rg_v turn[RG_GROUPS];
    for (int i = 0; i < RG_GROUPS; i++) {
        turning[i] = rg_avoid_v(m, &g[i], step);
        taxis[i] = rg_pick_m(g[i].food, g[i].taxis[1], g[i].taxis[0]) & ~turning[i];
        turn[i] = g[i].search_turn;
    }
    rg_m someone = {0};
    for (int i = 0; i < RG_GROUPS; i++)
        someone |= taxis[i];
    if (rg_which(someone != 0) != 0)
        rg_follow_v(m, g, step, time, taxis, turn);
    for (int i = 0; i < RG_GROUPS; i++) {
        const rg_v cruise = g[i].cruise_speed, inner = cruise * (1.0 - rg_abs_v(turn[i]));
        const rg_v spin = g[i].avoid_direction * g[i].avoid_speed;
        const rg_m left = turn[i] > 0.0;
        command[i][0] = rg_pick(turning[i], -spin, rg_pick(left, inner, cruise));
        command[i][1] = rg_pick(turning[i], spin, rg_pick(left, cruise, inner));
    }
}

/* rg_wheel_advance */
RG_INLINE rg_v rg_wheel_advance_v(const rg_drive *d, int side, rg_v *speed, rg_v command,
                                  const rg_part *part, double time) {
    const double h = part->h;
    const rg_v wanted = rg_abs_v(command);
    const rg_v magnitude = rg_pick(wanted < d->dead_zone[side], (rg_v){0}, wanted);
    const double drooped = rg_max(1.0 - d->droop_rate * time, 0.0);
    const rg_v target =
        rg_sign_v(rg_min_v(magnitude, rg_all(d->speed_limit[side])) * drooped, command);
    const double most = d->acceleration[side];
    const rg_v start = *speed, step = target - start, size = rg_abs_v(step);
    if (d->time_constant > 0.0) {
        const rg_v ramp = rg_min_v(size / most - d->time_constant, rg_all(h));
        const rg_m ramps = ramp > 0.0;
        const rg_v change = rg_sign_v(most * ramp, step);
        const rg_v away = rg_pick(ramps, step - change, step);
        const rg_v rest = rg_pick(ramps, h - ramp, rg_all(h));
        const rg_v before = rg_pick(ramps, (start + 0.5 * change) * ramp, (rg_v){0});
        rg_v left = rg_all(part->left);
        if (rg_which(ramps) != 0)
            left = rg_pick(ramps, rg_decay_v(rest / d->time_constant), left);
        *speed = target - away * left;
        return before + (target * rest - away * d->time_constant * (1.0 - left));
    }
    if (isinf(most)) {
        *speed = target;
        return target * h;
    }
    const rg_m limited = size > most * h;
    const rg_v end = start + rg_sign_v(rg_all(most * h), step);
    *speed = rg_pick(limited, end, target);
    return rg_pick(limited, 0.5 * (start + end) * h, target * h - 0.5 * step * size / most);
}

/* Drive a part of a step under one command: rg_wheel_advance and rg_arc. */
RG_INLINE void rg_drive_part_v(const rg_drive *d, rg_group *g, const rg_v *command,
                               const rg_part *part, double time) {
    const rg_v sl =
        d->wheel_radius[0] * rg_wheel_advance_v(d, 0, &g->speed[0], command[0], part, time);
    const rg_v sr =
        d->wheel_radius[1] * rg_wheel_advance_v(d, 1, &g->speed[1], command[1], part, time);
    const rg_v half = 0.5 * ((sr - sl) / d->axle);
    rg_v sinc, cosine;
    rg_turn_v(half, &sinc, &cosine);
    const rg_v sine = half * sinc, chord = 0.5 * (sl + sr) * sinc;
    const rg_v c = g->cosine, s = g->sine;
    g->x += chord * (c * cosine - s * sine);
    g->y += chord * (s * cosine + c * sine);
    const rg_v turned_c = cosine * cosine - sine * sine, turned_s = 2.0 * sine * cosine;
    const rg_v next_c = c * turned_c - s * turned_s, next_s = s * turned_c + c * turned_s;
    const rg_v unit = 1.5 - 0.5 * (next_c * next_c + next_s * next_s);
    g->cosine = next_c * unit;
    g->sine = next_s * unit;
}

RG_INLINE void rg_drive_step_v(const rg_model *m, const rg_cut *cut, rg_group *g, int32_t step,
                               double time, const rg_v *command) {
    const rg_drive *d = &m->drive;
    const rg_v *present = command;
    if (cut->whole > 0 || cut->old.h > 0.0) {
        memcpy(g->queue[step & (RG_COMMAND_SLOTS - 1)], command, sizeof g->queue[0]);
        present = g->queue[(step - cut->whole) & (RG_COMMAND_SLOTS - 1)];
    }
    if (cut->old.h > 0.0) {
        const rg_v *before = g->queue[(step - cut->whole - 1) & (RG_COMMAND_SLOTS - 1)];
        rg_drive_part_v(d, g, before, &cut->old, time);
    }
    rg_drive_part_v(d, g, present, &cut->rest, time);
    const double reach = m->arena_radius - m->body_radius;
    const rg_v square = g->x * g->x + g->y * g->y;
    const rg_m beyond = square > reach * reach;
    if (rg_which(beyond) != 0) {
        const rg_v back = rg_pick(beyond, reach / rg_sqrt_v(square), rg_all(1.0));
        g->x *= back;
        g->y *= back;
    }
}

/* Runs both groups, whose instructions overlap; whether every number stayed finite. */
static int rg_run(const rg_model *m, rg_group g[RG_GROUPS], int32_t steps) {
    const rg_cut cut = rg_cut_of(m);
    const double t_max = steps * m->control_step;
    double time = 0.0;
    for (int32_t step = 0; step < steps; step++) {
        rg_v command[RG_GROUPS][2];
        for (int i = 0; i < RG_GROUPS; i++)
            rg_handle_food_v(m, &g[i], t_max - step * m->control_step);
        rg_decide_v(m, g, (uint32_t)step, time, command);
        rg_m wrong = {0};
        for (int i = 0; i < RG_GROUPS; i++) {
            rg_drive_step_v(m, &cut, &g[i], step, time, command[i]);
            const rg_v sum = g[i].x + g[i].y + g[i].cosine + g[i].sine;
            wrong |= sum - sum != 0.0;
        }
        time += m->control_step;
        if (rg_which(wrong) != 0)
            return 0;
    }
    return 1;
}

int RG_FORAGE_LANES(const rg_model *m, const rg_behaviour *b, rg_trials *set,
                    const int32_t trials[RG_TOGETHER]) {
    rg_group groups[RG_GROUPS];
    memset(groups, 0, sizeof groups);
    for (int i = 0; i < RG_TOGETHER; i++) {
        const rg_behaviour *own = set->behaviours ? &set->behaviours[trials[i]] : b;
        rg_join(&groups[i / RG_LANES], i % RG_LANES, m, own, set, trials[i]);
    }
    if (!rg_run(m, groups, set->steps))
        return 0;
    for (int i = 0; i < RG_TOGETHER; i++) {
        set->fitness[trials[i]] = groups[i / RG_LANES].fitness[i % RG_LANES];
        set->deposits[trials[i]] = groups[i / RG_LANES].deposits[i % RG_LANES];
    }
    return 1;
}

/* Phototaxis of trials side by side: what controller.c and sensors.h do for one. */
#ifndef RG_GROUP_LIGHT_H
#define RG_GROUP_LIGHT_H

#include "group_state.h"

/* A lamp as each group's trials have it: where it is, and its power. */
typedef struct {
    rg_v x[RG_GROUPS], y[RG_GROUPS], gain[RG_GROUPS];
} rg_lamps;

/* What rg_lamp does, to the sensors ls of the trials that look (bits). Bearing and distance are
 * told for a group together, readings for one trial after the other, whose sensors lie in lanes:
 * they need two rows of the table and no more, and who does not look costs nothing. */
RG_INLINE void rg_lamp_v(const rg_model *m, const rg_group *g, int n, uint64_t looks,
                         const rg_lamps *lamp, rg_v (*ls)[RG_BLOCKS]) {
    const rg_tables *t = &m->tables;
    const int around = 3 * t->ls_bearings + 1;
    const double per_rad = t->ls_bearings / RG_TWO_PI;
    /* the node that a trial's first sensor looks up, and how many hold all its sensors' */
    double most = m->sensor_angle[0], least = m->sensor_angle[0];
    for (int k = 1; k < RG_SENSORS; k++) {
        most = rg_max(most, m->sensor_angle[k]);
        least = rg_min(least, m->sensor_angle[k]);
    }
    const int nodes = (int)((most - least) * per_rad) + 3;
    rg_v bearing[RG_GROUPS], weight[RG_GROUPS];
    rg_m row[RG_GROUPS], first[RG_GROUPS];
    for (int i = 0; i < n; i++) {
        looks &= ~(rg_which(lamp->gain[i] == 0.0) << i * RG_LANES);
        if (!rg_group_of(looks, i))
            continue;
        const rg_v dx = lamp->x[i] - g[i].x, dy = lamp->y[i] - g[i].y;
        const rg_v c = g[i].cosine, s = g[i].sine;
        const rg_v to = rg_angle_v(c * dy - s * dx, c * dx + s * dy);
        bearing[i] = rg_clip_v(to, -RG_PI, RG_PI);
        const rg_v u = rg_sqrt_v(rg_sqrt_v(dx * dx + dy * dy) / t->ls_range);
        row[i] = rg_node_v(u, t->ls_distances, &weight[i]) * around;
        first[i] = rg_whole_v((bearing[i] - most + 1.5 * RG_TWO_PI) * per_rad);
    }
    RG_EACH(l, looks) {
        const uint64_t i = l / RG_LANES, lane = l % RG_LANES;
        const int64_t from = first[i][lane];
        const float *near = t->ls_counts + row[i][lane] + from;
        const double wd = weight[i][lane], gain = lamp->gain[i][lane];
        for (int b = 0; b < RG_BLOCKS; b++) {
            const rg_v angle = rg_load_v(m->sensor_angle + b * RG_LANES);
            const rg_v at = (bearing[i][lane] - angle + 1.5 * RG_TWO_PI) * per_rad;
            const rg_m j = rg_whole_v(at);
            const rg_v wb = at - rg_number_v(j), no_wb = 1.0 - wb;
            rg_v low[2], high[2];
            rg_neighbours_v(near, j - from, nodes, low);
            rg_neighbours_v(near + around, j - from, nodes, high);
            const rg_v lit =
                (1.0 - wd) * (no_wb * low[0] + wb * low[1]) + wd * (no_wb * high[0] + wb * high[1]);
            ls[l][b] -= rg_load_v(m->ls_gain + b * RG_LANES) * gain * lit;
        }
    }
}

/* Largest or smallest of eight. */
#define RG_MOST(pick, x)                                                                           \
    pick(pick(pick(x[0], x[1]), pick(x[2], x[3])), pick(pick(x[4], x[5]), pick(x[6], x[7])))

/* Phototaxis over search's turn, where a lane of a group follows light (taxis) and sees it. lit:
 * its trials' sensors, without noise. */
RG_INLINE rg_v rg_follow_v(const rg_model *m, const rg_group *g, uint32_t step, rg_m taxis,
                           rg_v (*lit)[RG_BLOCKS], rg_v turn) {
    const rg_tables *t = &m->tables;
    const rg_behaviour *b = g->behaviour[0]; /* where the sensors are is the same for all */
    rg_v ls[RG_SENSORS], noise[RG_SENSORS], forward[RG_SENSORS], leftward[RG_SENSORS];
    rg_noise_v(g->seed, step, RG_NOISE_LS, t->ls_noise, noise);
    for (int k = 0; k < RG_SENSORS; k += RG_LANES) {
        for (int l = 0; l < RG_LANES; l++)
            ls[k + l] = lit[l][k / RG_LANES];
        rg_transpose_v(ls + k);
    }
    for (int k = 0; k < RG_SENSORS; k++)
        ls[k] = rg_clip_v(rg_max_v(ls[k], (rg_v){0}) + noise[k], 0.0, t->counts_max);
    const rg_v dark = RG_MOST(rg_max_v, ls), seen = dark - RG_MOST(rg_min_v, ls);
    for (int k = 0; k < RG_SENSORS; k++) {
        forward[k] = (dark - ls[k]) * b->sensor_cos[k];
        leftward[k] = (dark - ls[k]) * b->sensor_sin[k];
    }
    const rg_v bearing = rg_angle_v(RG_SUM(leftward), RG_SUM(forward));
    const rg_v back = bearing - rg_sign_v(rg_all(RG_PI), bearing);
    const rg_v towards = rg_pick(taxis < 0, back, bearing);
    const rg_v follow = rg_clip_v(g->light_gain * towards, -2.0, 2.0);
    const rg_v both = rg_clip_v(follow + g->light_search * turn, -2.0, 2.0);
    return rg_pick((taxis != 0) & (seen >= g->light_contrast), both, turn);
}

/* rg_ls and phototaxis of all groups */
RG_INLINE void rg_light_v(const rg_model *m, const rg_group *g, int n, uint32_t step, double time,
                          const rg_m *taxis, rg_v *turn) {
    const double power = m->lamp_gain * rg_max(1.0 - m->lamp_decay * time, 0.0);
    rg_v ls[RG_TOGETHER][RG_BLOCKS];
    rg_lamps captured, second;
    uint64_t looks = 0;
    for (int i = 0; i < n; i++) {
        looks |= rg_which(taxis[i] != 0) << i * RG_LANES;
        captured.x[i] = g[i].lamp_x;
        captured.y[i] = g[i].lamp_y;
        captured.gain[i] = power * g[i].lamp_on;
        second.x[i] = rg_all(m->second_x);
        second.y[i] = rg_all(m->second_y);
        second.gain[i] = rg_all(m->second_gain);
    }
    if (looks == 0)
        return;
    for (int l = 0; l < n * RG_LANES; l++)
        for (int b = 0; b < RG_BLOCKS; b++)
            ls[l][b] = rg_load_v(m->tables.ls_dark + b * RG_LANES);
    rg_lamp_v(m, g, n, looks, &captured, ls);
    if (m->second_gain > 0.0)
        rg_lamp_v(m, g, n, looks, &second, ls);
    for (int i = 0; i < n; i++)
        if (rg_group_of(looks, i))
            turn[i] = rg_follow_v(m, &g[i], step, taxis[i], ls + i * RG_LANES, turn[i]);
}

#endif

/* Phototaxis of trials side by side: what controller.c and sensors.h do for one. */
#ifndef RG_GROUP_LIGHT_H
#define RG_GROUP_LIGHT_H

#include "group_state.h"

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

#endif

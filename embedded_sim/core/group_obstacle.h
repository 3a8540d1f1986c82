/* Obstacles of trials side by side: what trial.h does for one. Few trials see the wall at a time:
 * one after the other, with their sensors in lanes. */
#ifndef RG_GROUP_OBSTACLE_H
#define RG_GROUP_OBSTACLE_H

#include "group_state.h"
#include "noise.h"

/* Trials that may see an obstacle: a sensor's reach ends at the wall or beyond it. rg_sees_wall
 * asks the same from the rim; RG_MARGIN is for what the two round differently. */
RG_INLINE rg_m rg_may_see_v(const rg_model *m, const rg_group *g) {
    const rg_v ahead = g->cosine * g->x + g->sine * g->y;
    const rg_v leftward = g->cosine * g->y - g->sine * g->x;
    const double wall = m->arena_radius * m->arena_radius * (1.0 - RG_MARGIN);
    const rg_v room = wall - (g->x * g->x + g->y * g->y);
    rg_m may = {0};
    RG_EACH(k, g->watched) {
        const rg_v along = ahead * m->sensor_cos[k] + leftward * m->sensor_sin[k];
        may |= ~(g->ray[k] * (2.0 * along + g->ray[k]) <= room);
    }
    return may;
}

/* What sensors k, k + 1, ... of the trial in lane l read, in thresholds: 0 where whatever the noise
 * they see no obstacle. */
RG_INLINE rg_v rg_near_wall_v(const rg_model *m, const rg_group *g, uint64_t l,
                              const uint32_t noise[4], int k) {
    const rg_tables *t = &m->tables;
    const double x = g->x[l], y = g->y[l], c = g->cosine[l], s = g->sine[l];
    const rg_v cosine = rg_load_v(m->sensor_cos + k), sine = rg_load_v(m->sensor_sin + k);
    const rg_v ux = c * cosine - s * sine, uy = s * cosine + c * sine;
    /* rg_sees_wall */
    const rg_v reach = rg_load_v(g->watch[l].reach + k);
    const rg_v px = x + m->body_radius * ux, py = y + m->body_radius * uy;
    const rg_v along = px * ux + py * uy;
    const rg_v margin = m->arena_radius * m->arena_radius - px * px - py * py;
    const rg_m sees = (reach > 0.0) & ~(reach * (2.0 * along + reach) <= margin);
    if (rg_which(sees) == 0)
        return (rg_v){0};
    /* rg_wall_reading */
    const rg_v inside = along * along + margin, root = rg_sqrt_v(inside);
    const rg_v distance = rg_max_v(root - along, (rg_v){0});
    rg_v wd, wi;
    const rg_m i = rg_node_v(rg_sqrt_v(distance / t->ps_range), t->ps_distances, &wd);
    const rg_m j = rg_node_v(root / m->arena_radius, t->ps_incidences, &wi);
    const rg_m at = ((rg_lane + k) * t->ps_distances + i) * t->ps_incidences + j;
    const rg_u low = rg_pairs_v(t->ps_counts, at);
    const rg_u high = rg_pairs_v(t->ps_counts, at + t->ps_incidences);
    const rg_v read = (1.0 - wd) * ((1.0 - wi) * rg_first_v(low) + wi * rg_first_v(low >> 32)) +
                      wd * ((1.0 - wi) * rg_first_v(high) + wi * rg_first_v(high >> 32));
    const rg_m ends = t->ps_range * (2.0 * along + t->ps_range) <= margin;
    const rg_v wall = rg_load_v(m->ps_gain + k) * rg_pick(ends | (inside <= 0.0), (rg_v){0}, read);
    /* rg_look_ahead */
    const rg_v threshold = rg_load_v(g->behaviour[l]->avoid_threshold + k);
    const rg_v ps = rg_load_v(m->ps_offset + k) + wall;
    const rg_v noisy = rg_load_v(t->ps_noise + k) * wall + t->ps_noise_floor;
    const rg_m may = sees & ~(ps + rg_abs_v(noisy) < threshold * (1.0 - RG_MARGIN));
    const rg_v counts = rg_clip_v(ps + noisy * rg_noise_of_v(noise, k), 0.0, t->counts_max);
    return rg_pick(may, counts / threshold, (rg_v){0});
}

/* rg_look_ahead of the trial in lane l */
RG_INLINE int32_t rg_look_ahead_v(const rg_model *m, const rg_group *g, uint64_t l, uint32_t step) {
    uint32_t noise[4];
    rg_noise_words(g->words[l], step, RG_NOISE_PS, noise);
    double near[RG_SENSORS];
    for (int k = 0; k < RG_SENSORS; k += RG_LANES) {
        const rg_v block = rg_near_wall_v(m, g, l, noise, k);
        memcpy(near + k, &block, sizeof block);
    }
    return rg_obstacle(rg_max(rg_max(near[0], near[1]), rg_max(near[2], near[3])),
                       rg_max(rg_max(near[4], near[5]), rg_max(near[6], near[7])));
}

/* Trials, as bits, with an obstacle that is nearer on the right, and with one that is not. */
RG_INLINE void rg_obstacles_v(const rg_model *m, const rg_group *g, int n, uint32_t step,
                              uint64_t *right, uint64_t *left) {
    uint64_t may = 0;
    for (int i = 0; i < n; i++) {
        const rg_m open = g[i].avoid_steps <= g[i].memory;
        may |= rg_which(open & rg_may_see_v(m, &g[i])) << i * RG_LANES;
    }
    *right = *left = 0;
    RG_EACH(l, may) {
        const int32_t side = rg_look_ahead_v(m, &g[l / RG_LANES], l % RG_LANES, step);
        *right |= (uint64_t)(side > 0) << l;
        *left |= (uint64_t)(side < 0) << l;
    }
}

#endif

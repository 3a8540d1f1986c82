/* Driving trials side by side: what drive.h and forage.c do for one. */
#ifndef RG_GROUP_DRIVE_H
#define RG_GROUP_DRIVE_H

#include <math.h>
#include <string.h>

#include "group_laws.h"
#include "group_state.h"

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
        rg_v before = {0}, rest = rg_all(h), away = step, left = rg_all(part->left);
        /* most steps ask for less than the limit gives: then there is nothing to divide */
        if (rg_which(size > most * d->time_constant * (1.0 - RG_MARGIN)) != 0) {
            const rg_v ramp = rg_min_v(size / most - d->time_constant, rg_all(h));
            const rg_m ramps = ramp > 0.0;
            const rg_v change = rg_sign_v(most * ramp, step);
            before = rg_pick(ramps, (start + 0.5 * change) * ramp, before);
            rest = rg_pick(ramps, h - ramp, rest);
            away = rg_pick(ramps, step - change, away);
            left = rg_pick(ramps, rg_decay_v(rest / d->time_constant), left);
        }
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

/* rg_wheels_advance; what shapes commands is rare, and asked lane by lane */
RG_INLINE void rg_wheels_advance_v(const rg_drive *d, rg_group *g, const rg_v *told,
                                   const rg_part *part, double time, rg_v turned[2]) {
    if (!part->shaped) {
        for (int side = 0; side < 2; side++)
            turned[side] = rg_wheel_advance_v(d, side, &g->speed[side], told[side], part, time);
        return;
    }
    for (int l = 0; l < RG_LANES; l++) {
        const double own[2] = {told[0][l], told[1][l]};
        rg_wheels wheels = {{g->speed[0][l], g->speed[1][l]}, {g->asked[0][l], g->asked[1][l]}};
        double angle[2];
        rg_wheels_advance(d, &wheels, own, part, time, angle);
        for (int side = 0; side < 2; side++) {
            g->speed[side][l] = wheels.speed[side];
            g->asked[side][l] = wheels.asked[side];
            turned[side][l] = angle[side];
        }
    }
}

/* Drive a part of a step under one command: rg_wheels_advance and rg_arc, or rg_arc_of. */
RG_INLINE void rg_drive_part_v(const rg_drive *d, rg_group *g, const rg_v *command,
                               const rg_part *part, double time) {
    rg_v turned[2];
    rg_wheels_advance_v(d, g, command, part, time, turned);
    const rg_v left = turned[0], right = turned[1];
    const rg_v sl = d->wheel_radius[0] * left, sr = d->wheel_radius[1] * right;
    rg_moved_v moved = {0.5 * (sl + sr), (sr - sl) / d->axle, {0}};
    if (d->laws > 0)
        moved = rg_obey_v(d, g, part->h, time, left, right);
    const rg_v half = 0.5 * moved.turn;
    rg_v sinc, cosine;
    rg_turn_v(half, &sinc, &cosine);
    const rg_v sine = half * sinc, chord = moved.ahead * sinc;
    const rg_v c = g->cosine, s = g->sine;
    const rg_v to_x = c * cosine - s * sine, to_y = s * cosine + c * sine;
    if (d->laws > 0) {
        const rg_v across = moved.aside * sinc;
        g->x += chord * to_x - across * to_y;
        g->y += chord * to_y + across * to_x;
    } else {
        g->x += chord * to_x;
        g->y += chord * to_y;
    }
    const rg_v turned_c = cosine * cosine - sine * sine, turned_s = 2.0 * sine * cosine;
    const rg_v next_c = c * turned_c - s * turned_s, next_s = s * turned_c + c * turned_s;
    const rg_v unit = 1.5 - 0.5 * (next_c * next_c + next_s * next_s);
    g->cosine = next_c * unit;
    g->sine = next_s * unit;
}

/* A control step of all groups: each part for all of them, so that their instructions overlap. */
RG_INLINE void rg_drive_step_v(const rg_model *m, const rg_cut *cut, rg_group *g, int n,
                               int32_t step, double time, rg_v (*command)[2]) {
    const rg_drive *d = &m->drive;
    const int newest = step & (RG_COMMAND_SLOTS - 1);
    const int present = (step - cut->whole) & (RG_COMMAND_SLOTS - 1);
    const int before = (step - cut->whole - 1) & (RG_COMMAND_SLOTS - 1);
    const int late = cut->whole > 0 || cut->old.h > 0.0;
    for (int i = 0; i < n && late; i++)
        for (int side = 0; side < 2; side++)
            g[i].queue[newest][side] = command[i][side];
    for (int i = 0; i < n && cut->old.h > 0.0; i++)
        rg_drive_part_v(d, &g[i], g[i].queue[before], &cut->old, time);
    const double reach = m->arena_radius - m->body_radius;
    for (int i = 0; i < n; i++) {
        rg_drive_part_v(d, &g[i], late ? g[i].queue[present] : command[i], &cut->rest, time);
        const rg_v square = g[i].x * g[i].x + g[i].y * g[i].y;
        const rg_m beyond = square > reach * reach;
        if (rg_which(beyond) != 0) {
            const rg_v back = rg_pick(beyond, reach / rg_sqrt_v(square), rg_all(1.0));
            g[i].x *= back;
            g[i].y *= back;
        }
    }
}

#endif

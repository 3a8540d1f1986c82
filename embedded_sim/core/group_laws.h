/* Laws of trials side by side: what laws.h does for one, and the same bits. What no vector has,
 * such as a curve, is asked lane by lane. */
#ifndef RG_GROUP_LAWS_H
#define RG_GROUP_LAWS_H

#include "group_state.h"
#include "laws.h"

typedef struct {
    rg_v x, y, cosine, sine;
    double time;
    rg_v wheel_speed, speed, turn;
} rg_known_v;

typedef struct {
    rg_v ahead, turn, aside;
} rg_moved_v;

/* One lane's. A simulated robot is alone. */
RG_INLINE rg_known rg_lane_of(const rg_known_v *q, int l) {
    return (rg_known){{q->x[l], q->y[l], q->cosine[l], q->sine[l], INFINITY, q->time},
                      q->wheel_speed[l],
                      q->speed[l],
                      q->turn[l]};
}

RG_INLINE rg_v rg_harmonic_v(const rg_atom *a, const rg_known_v *q) {
    rg_v c = rg_all(1.0), s = {0};
    for (int k = (int)a->number[0]; k > 0; k--) {
        const rg_v next = c * q->cosine - s * q->sine;
        s = s * q->cosine + c * q->sine;
        c = next;
    }
    return c * a->number[2] + s * a->number[3];
}

RG_INLINE rg_v rg_curve_v(const rg_atom *a, rg_v q) {
    const int last = a->numbers - 3;
    const double span = a->number[1] - a->number[0];
    const rg_v along = rg_clip_v((q - a->number[0]) / span, 0.0, 1.0) * (double)last;
    rg_m node = rg_whole_v(along);
    node = rg_pick_m(node > last - 1, (rg_m){0} + (last - 1), node);
    const rg_v share = along - rg_number_v(node);
    rg_v low, high;
    for (int l = 0; l < RG_LANES; l++) {
        low[l] = a->number[2 + node[l]];
        high[l] = a->number[3 + node[l]];
    }
    return low * (1.0 - share) + high * share;
}

RG_INLINE rg_v rg_quantity_v(const rg_drive *d, const rg_atom *a, const rg_known_v *q) {
    const rg_v x = q->x, y = q->y;
    switch (a->of) {
    case RG_OF_WHEEL_SPEED:
        return q->wheel_speed;
    case RG_OF_SPEED:
        return q->speed;
    case RG_OF_TURN:
        return q->turn;
    case RG_OF_HEADING: {
        const rg_v angle = rg_angle_v(q->sine, q->cosine);
        return rg_pick(angle < 0.0, angle + 2.0 * RG_PI, angle);
    }
    case RG_OF_RADIUS:
        return rg_sqrt_v(x * x + y * y);
    default:
        return d->reach - rg_sqrt_v(x * x + y * y);
    }
}

RG_INLINE rg_v rg_atom_value_v(const rg_drive *d, const rg_atom *a, const rg_known_v *q) {
    const double *p = a->number;
    const rg_v x = q->x, y = q->y, one = rg_all(1.0), none = {0};
    if (a->form == RG_SLOPE)
        return (x * p[2] + y * p[3]) / p[0];
    if (a->form == RG_HALF)
        return rg_pick(x * p[2] + y * p[3] > p[1], one, none);
    if (a->form == RG_DISC)
        return rg_pick((x - p[0]) * (x - p[0]) + (y - p[1]) * (y - p[1]) < p[2] * p[2], one, none);
    if (a->form == RG_COSINE && a->of == RG_OF_HEADING)
        return rg_harmonic_v(a, q);
    if (a->form == RG_ALWAYS)
        return one;
    if (a->of == RG_OF_TIME || a->of == RG_OF_GAP) { /* the same for all of them */
        const rg_known first = rg_lane_of(q, 0);
        return rg_all(rg_atom_value(d, a, &first));
    }
    const rg_v of = rg_quantity_v(d, a, q);
    const rg_v size = a->of <= RG_OF_TURN ? rg_abs_v(of) : of;
    switch (a->form) {
    case RG_SIGN:
        return rg_pick(of > 0.0, one, none) - rg_pick(of < 0.0, one, none);
    case RG_BELOW:
        return rg_pick(size < p[0], one, none);
    case RG_OVER:
        return 1.0 - p[0] / rg_max_v(rg_abs_v(of), rg_all(p[0]));
    case RG_POWER:
        return (p[1] == 1.0 ? rg_abs_v(of) : rg_power_v(rg_abs_v(of), p[1])) * p[2];
    case RG_FADE:
        return rg_two_to_v(rg_pick(of > 0.0, of, none) * p[1]);
    case RG_CURVE:
        return rg_curve_v(a, of);
    default: { /* a cosine */
        rg_v found = none;
        for (int l = 0; l < RG_LANES; l++)
            found[l] = cos(p[0] * of[l] - p[1]);
        return found;
    }
    }
}

RG_INLINE rg_v rg_strength_v(const rg_drive *d, const rg_law *law, const rg_known_v *q) {
    rg_v strength = rg_all(law->amplitude);
    for (int i = 0; i < law->atoms; i++)
        strength *= rg_atom_value_v(d, &law->atom[i], q);
    return strength;
}

/* rg_obey */
RG_INLINE rg_moved_v rg_obey_v(const rg_drive *d, const rg_group *g, double h, double time,
                               rg_v left, rg_v right) {
    const double lean = 1.0 / d->axle;
    const rg_v turned[2] = {left, right};
    rg_v way[2] = {d->wheel_radius[0] * left, d->wheel_radius[1] * right};
    const rg_moved_v plain = {0.5 * (way[0] + way[1]), (way[1] - way[0]) * lean, {0}};
    if (!(h > 0.0))
        return plain;
    const rg_v half = 0.5 * plain.turn, on = 0.5 * plain.ahead;
    const double per = 1.0 / h;
    rg_known_v q = {g->x,           g->y, g->cosine,         g->sine,
                    time + 0.5 * h, {0},  plain.ahead * per, plain.turn * per};
    q.cosine = g->cosine * (1.0 - 0.5 * half * half) - g->sine * half;
    q.sine = g->sine * (1.0 - 0.5 * half * half) + g->cosine * half;
    q.x += on * q.cosine;
    q.y += on * q.sine;
    const rg_m moves = rg_max_v(rg_abs_v(left), rg_abs_v(right)) > RG_STANDS * h;
    rg_v share[2] = {{0}, {0}}, ahead = {0}, turning = {0}, turn = {0}, aside = {0};
    for (int i = 0; i < d->laws; i++) {
        const rg_law *law = &d->law[i];
        if (law->channel <= RG_BOTH) {
            rg_v strength = {0};
            for (int side = 0; side < 2; side++) {
                if (law->channel == !side)
                    continue;
                q.wheel_speed = turned[side] * per;
                if (side == 0 || law->channel == RG_RIGHT || rg_of_wheels(law))
                    strength = rg_strength_v(d, law, &q);
                share[side] += strength;
            }
            continue;
        }
        const rg_v strength = rg_strength_v(d, law, &q);
        if (law->channel == RG_SPEED)
            ahead += strength;
        else if (law->channel == RG_TURNING)
            turning += strength;
        else if (law->channel == RG_TURN)
            turn += rg_pick(moves, strength * h, (rg_v){0});
        else if (law->channel == RG_BEND)
            turn += strength * rg_abs_v(plain.ahead);
        else
            aside += strength * plain.ahead;
    }
    for (int side = 0; side < 2; side++)
        way[side] *= 1.0 + share[side];
    return (rg_moved_v){0.5 * (way[0] + way[1]) * (1.0 + ahead),
                        (way[1] - way[0]) * lean * (1.0 + turning) + turn, aside};
}

#endif

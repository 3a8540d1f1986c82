/* Laws: terms that a model adds to what its wheels and its body do. Nothing here is asked of a
 * drive without laws. */
#ifndef RG_LAWS_H
#define RG_LAWS_H

#include <math.h>

#include "drive.h"
#include "realitygap_core.h"

#define RG_STANDS 0.01 /* rad/s: floor and tyres hold a robot whose wheels turn slower */

/* Where and when a robot is while it obeys: what a step alone does not tell. */
typedef struct {
    double x, y;         /* m */
    double cosine, sine; /* of its heading */
    double distance;     /* m to the next robot's middle */
    double time;         /* s since the run began */
} rg_place_of;

/* What atoms are of, at the middle of a step. */
typedef struct {
    rg_place_of at;
    double wheel_speed, speed, turn; /* rad/s of the wheel that is asked; m/s; rad/s */
} rg_known;

/* cos(k heading - phase) from the heading's cosine and sine; numbers: k, phase, cosine and sine of
 * the phase. k is whole. */
static inline double rg_harmonic(const rg_atom *a, const rg_known *q) {
    double c = 1.0, s = 0.0;
    for (int k = (int)a->number[0]; k > 0; k--) {
        const double next = c * q->at.cosine - s * q->at.sine;
        s = s * q->at.cosine + c * q->at.sine;
        c = next;
    }
    return c * a->number[2] + s * a->number[3];
}

static inline double rg_curve(const rg_atom *a, double q) {
    const int last = a->numbers - 3; /* of the nodes, which begin at number 2 */
    const double span = a->number[1] - a->number[0];
    const double along = rg_clip((q - a->number[0]) / span, 0.0, 1.0) * last;
    const int node = along < last ? (int)along : last - 1;
    const double share = along - node;
    return a->number[2 + node] * (1.0 - share) + a->number[3 + node] * share;
}

static inline double rg_quantity(const rg_drive *d, const rg_atom *a, const rg_known *q) {
    const double x = q->at.x, y = q->at.y;
    switch (a->of) {
    case RG_OF_WHEEL_SPEED:
        return q->wheel_speed;
    case RG_OF_SPEED:
        return q->speed;
    case RG_OF_TURN:
        return q->turn;
    case RG_OF_HEADING: {
        const double angle = rg_angle(q->at.sine, q->at.cosine);
        return angle < 0.0 ? angle + 2.0 * RG_PI : angle;
    }
    case RG_OF_RADIUS:
        return sqrt(x * x + y * y);
    case RG_OF_WALL:
        return d->reach - sqrt(x * x + y * y);
    case RG_OF_GAP:
        return q->at.distance - 2.0 * d->body;
    default:
        return q->at.time;
    }
}

static inline double rg_atom_value(const rg_drive *d, const rg_atom *a, const rg_known *q) {
    const double *p = a->number, x = q->at.x, y = q->at.y;
    if (a->form == RG_SLOPE) /* scale, direction, its cosine and sine */
        return (x * p[2] + y * p[3]) / p[0];
    if (a->form == RG_HALF) /* direction, edge, cosine and sine */
        return x * p[2] + y * p[3] > p[1] ? 1.0 : 0.0;
    if (a->form == RG_DISC)
        return (x - p[0]) * (x - p[0]) + (y - p[1]) * (y - p[1]) < p[2] * p[2] ? 1.0 : 0.0;
    if (a->form == RG_COSINE && a->of == RG_OF_HEADING)
        return rg_harmonic(a, q);
    if (a->form == RG_ALWAYS)
        return 1.0;
    const double of = rg_quantity(d, a, q);
    switch (a->form) {
    case RG_POWER: /* scale, exponent, scale^-exponent */
        return (p[1] == 1.0 ? fabs(of) : rg_power(fabs(of), p[1])) * p[2];
    case RG_SIGN:
        return (of > 0.0) - (of < 0.0);
    case RG_COSINE:
        return cos(p[0] * of - p[1]);
    case RG_BELOW:
        return (a->of <= RG_OF_TURN ? fabs(of) : of) < p[0] ? 1.0 : 0.0;
    case RG_OVER:
        return 1.0 - p[0] / rg_max(fabs(of), p[0]);
    case RG_FADE: /* scale, -log2(e) / scale */
        return rg_two_to((of > 0.0 ? of : 0.0) * p[1]);
    default:
        return rg_curve(a, of);
    }
}

static inline double rg_strength(const rg_drive *d, const rg_law *law, const rg_known *q) {
    double strength = law->amplitude;
    for (int i = 0; i < law->atoms; i++)
        strength *= rg_atom_value(d, &law->atom[i], q);
    return strength;
}

/* Whether a law has a strength of its own in each wheel. */
static inline int rg_of_wheels(const rg_law *law) {
    return law->atom[0].of == RG_OF_WHEEL_SPEED ||
           (law->atoms > 1 && law->atom[1].of == RG_OF_WHEEL_SPEED);
}

/* What a body does in a step: m ahead, rad counter-clockwise, m to the left. */
typedef struct {
    double ahead, turn, aside;
} rg_moved;

/* The step of wheels turned by left and right (rad) in h seconds, as laws have it. `at` is where
 * the step begins. */
static inline rg_moved rg_obey(const rg_drive *d, const rg_place_of *at, double h, double left,
                               double right) {
    const double turned[2] = {left, right}, lean = 1.0 / d->axle;
    double way[2] = {d->wheel_radius[0] * left, d->wheel_radius[1] * right};
    const rg_moved plain = {0.5 * (way[0] + way[1]), (way[1] - way[0]) * lean, 0.0};
    if (!(h > 0.0))
        return plain;
    const double half = 0.5 * plain.turn, on = 0.5 * plain.ahead;
    const double per = 1.0 / h;
    rg_known q = {*at, 0.0, plain.ahead * per, plain.turn * per};
    q.at.cosine = at->cosine * (1.0 - 0.5 * half * half) - at->sine * half;
    q.at.sine = at->sine * (1.0 - 0.5 * half * half) + at->cosine * half;
    q.at.x += on * q.at.cosine;
    q.at.y += on * q.at.sine;
    q.at.time += 0.5 * h;
    const int moves = rg_max(fabs(left), fabs(right)) > RG_STANDS * h;
    double share[2] = {0.0, 0.0}, ahead = 0.0, turning = 0.0, turn = 0.0, aside = 0.0;
    for (int i = 0; i < d->laws; i++) {
        const rg_law *law = &d->law[i];
        if (law->channel <= RG_BOTH) {
            double strength = 0.0;
            for (int side = 0; side < 2; side++) {
                if (law->channel == !side) /* RG_LEFT is of side 0 alone, RG_RIGHT of side 1 */
                    continue;
                q.wheel_speed = turned[side] * per;
                if (side == 0 || law->channel == RG_RIGHT || rg_of_wheels(law))
                    strength = rg_strength(d, law, &q);
                share[side] += strength;
            }
            continue;
        }
        const double strength = rg_strength(d, law, &q);
        if (law->channel == RG_SPEED)
            ahead += strength;
        else if (law->channel == RG_TURNING)
            turning += strength;
        else if (law->channel == RG_TURN)
            turn += moves ? strength * h : 0.0;
        else if (law->channel == RG_BEND)
            turn += strength * fabs(plain.ahead);
        else
            aside += strength * plain.ahead;
    }
    for (int side = 0; side < 2; side++)
        way[side] *= 1.0 + share[side];
    return (rg_moved){0.5 * (way[0] + way[1]) * (1.0 + ahead),
                      (way[1] - way[0]) * lean * (1.0 + turning) + turn, aside};
}

/* rg_arc, as laws have it. */
static inline double rg_arc_of(const rg_moved *moved, double *pose, double *heading) {
    const double half = 0.5 * moved->turn;
    double sinc, cosine;
    rg_turn(half, &sinc, &cosine);
    const double sine = half * sinc;
    const double chord = moved->ahead * sinc, across = moved->aside * sinc;
    const double c = heading[0], s = heading[1];
    const double to_x = c * cosine - s * sine, to_y = s * cosine + c * sine;
    pose[0] += chord * to_x - across * to_y;
    pose[1] += chord * to_y + across * to_x;
    pose[2] += moved->turn;
    const double turned_c = cosine * cosine - sine * sine, turned_s = 2.0 * sine * cosine;
    const double next_c = c * turned_c - s * turned_s, next_s = s * turned_c + c * turned_s;
    const double unit = 1.5 - 0.5 * (next_c * next_c + next_s * next_s);
    heading[0] = next_c * unit;
    heading[1] = next_s * unit;
    return fabs(chord) + fabs(across);
}

#endif

/* From command to motion: the motors' answer, and the exact arc of two wheels. */
#ifndef RG_DRIVE_H
#define RG_DRIVE_H

#include <math.h>

#include "realitygap_core.h"
#include "small.h"
#include "trig.h"

/* A time under one command, what a first-order lag leaves of a change of speed after it, and
 * whether the drive does anything with commands before its wheels obey. */
typedef struct {
    double h; /* s */
    double left;
    int shaped;
} rg_part;

static inline rg_part rg_part_of(const rg_drive *d, double h) {
    const int shaped =
        d->turn_first < INFINITY || d->start_delay > 0.0 || d->knots[0] | d->knots[1];
    return (rg_part){h, d->time_constant > 0.0 ? rg_decay(h / d->time_constant) : 0.0, shaped};
}

/* Angle (rad) wheel `side` turns in part->h seconds towards a delivered command, advancing its
 * speed. Chain: dead zone, saturation, droop, then a first-order lag whose change of speed is
 * limited, solved exactly: cutting h in two changes nothing. At the null values every factor is 1,
 * every term 0. */
static inline double rg_wheel_advance(const rg_drive *d, int side, double *speed, double command,
                                      const rg_part *part, double time) {
    const double h = part->h;
    const double magnitude = fabs(command) < d->dead_zone[side] ? 0.0 : fabs(command);
    const double drooped = rg_max(1.0 - d->droop_rate * time, 0.0);
    const double reached = rg_min(magnitude, d->speed_limit[side]) * drooped;
    const double target = copysign(reached, command);
    const double start = *speed;
    const double step = target - start;
    double end = target;
    double turned = target * h;
    if (d->time_constant > 0.0) {
        /* while the lag asks for more than the limit gives, speed changes at the limit */
        const double ramp = rg_min(fabs(step) / d->acceleration[side] - d->time_constant, h);
        double rest = h, away = step, left = part->left;
        turned = 0.0;
        if (ramp > 0.0) {
            const double change = copysign(d->acceleration[side] * ramp, step);
            turned = (start + 0.5 * change) * ramp;
            away = step - change;
            rest = h - ramp;
            left = rg_decay(rest / d->time_constant);
        }
        end = target - away * left;
        turned += target * rest - away * d->time_constant * (1.0 - left);
    } else if (fabs(step) > d->acceleration[side] * h) {
        end = start + copysign(d->acceleration[side] * h, step);
        turned = 0.5 * (start + end) * h;
    } else {
        turned = target * h - 0.5 * step * fabs(step) / d->acceleration[side];
    }
    *speed = end;
    return turned;
}

/* What a wheel does of a command: lines between the knots of its curve, and flat beyond them. */
static inline double rg_done(const rg_drive *d, int side, double command) {
    const double *told = d->told[side], *done = d->done[side];
    int i = 0;
    if (d->knots[side] == 0)
        return command;
    while (i < d->knots[side] - 2 && command > told[i + 1])
        i++;
    const double share = rg_clip((command - told[i]) / (told[i + 1] - told[i]), 0.0, 1.0);
    return done[i] + share * (done[i + 1] - done[i]);
}

/* What a robot's controller passes on of a command, and its wheels do of that. Where a wheel would
 * be too fast both give way alike, so that the turn rate stays, down to turning on the spot. */
static inline void rg_shape(const rg_drive *d, const double told[2], double command[2]) {
    const double most = d->turn_first;
    const double over = rg_max(fabs(told[0]), fabs(told[1])) - most;
    const double mean = 0.5 * (told[0] + told[1]);
    const double back = copysign(rg_min(over, fabs(mean)), mean);
    for (int side = 0; side < 2; side++)
        command[side] =
            rg_done(d, side, over > 0.0 ? rg_clip(told[side] - back, -most, most) : told[side]);
}

/* rg_wheel_advance of a wheel that is held still first where it starts, or turns the other way. */
static inline double rg_wheel_start(const rg_drive *d, int side, rg_wheels *w, double command,
                                    const rg_part *part, double time) {
    const double before = w->asked[side] * command > 0.0 ? fabs(w->asked[side]) : 0.0;
    const double held = rg_clip(d->start_delay - before, 0.0, part->h);
    const rg_part still = rg_part_of(d, held), rest = rg_part_of(d, part->h - held);
    double turned = 0.0;
    w->asked[side] = command == 0.0 ? 0.0 : copysign(before + part->h, command);
    if (held > 0.0)
        turned = rg_wheel_advance(d, side, &w->speed[side], 0.0, &still, time);
    if (rest.h > 0.0)
        turned += rg_wheel_advance(d, side, &w->speed[side], command, &rest, time + held);
    return turned;
}

/* rg_wheels_advance where commands are shaped: rare, and out of the way of all else. */
static __attribute__((noinline)) void rg_wheels_shaped(const rg_drive *d, rg_wheels *w,
                                                       const double told[2], const rg_part *part,
                                                       double time, double turned[2]) {
    double command[2];
    rg_shape(d, told, command);
    for (int side = 0; side < 2; side++)
        turned[side] = d->start_delay > 0.0
                           ? rg_wheel_start(d, side, w, command[side], part, time)
                           : rg_wheel_advance(d, side, &w->speed[side], command[side], part, time);
}

/* Angles (rad) both wheels turn in part->h seconds. */
static inline void rg_wheels_advance(const rg_drive *d, rg_wheels *w, const double told[2],
                                     const rg_part *part, double time, double turned[2]) {
    if (part->shaped) {
        rg_wheels_shaped(d, w, told, part, time, turned);
        return;
    }
    turned[0] = rg_wheel_advance(d, 0, &w->speed[0], told[0], part, time);
    turned[1] = rg_wheel_advance(d, 1, &w->speed[1], told[1], part, time);
}

/* Move a pose along the exact circular arc of wheels turned by left and right (rad). `heading` is
 * the cosine and sine of yaw: it is turned with the pose, so that a step costs one sine and cosine.
 * Returns how far the pose moved (m). */
static inline double rg_arc(const rg_drive *d, double left, double right, double *pose,
                            double *heading) {
    const double sl = d->wheel_radius[0] * left;
    const double sr = d->wheel_radius[1] * right;
    const double turn = (sr - sl) / d->axle;
    const double half = 0.5 * turn;
    double sinc, cosine; /* the chord of an arc is its length * sin(half) / half */
    rg_turn(half, &sinc, &cosine);
    const double sine = half * sinc;
    const double chord = 0.5 * (sl + sr) * sinc;
    const double c = heading[0], s = heading[1];
    pose[0] += chord * (c * cosine - s * sine);
    pose[1] += chord * (s * cosine + c * sine);
    pose[2] += turn;
    const double turned_c = cosine * cosine - sine * sine, turned_s = 2.0 * sine * cosine;
    const double next_c = c * turned_c - s * turned_s, next_s = s * turned_c + c * turned_s;
    const double unit = 1.5 - 0.5 * (next_c * next_c + next_s * next_s); /* rounding, undone */
    heading[0] = next_c * unit;
    heading[1] = next_s * unit;
    return fabs(chord);
}

#endif

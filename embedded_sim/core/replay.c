/* Logged commands through the point model, and what its sensors would have read. */
#include <math.h>
#include <stddef.h>

#include "check.h"
#include "drive.h"
#include "laws.h"
#include "realitygap_core.h"
#include "sensors.h"

/* Move a pose by wheels turned by l and r (rad) in h seconds as laws have it. */
static void rg_replay_laws(const rg_drive *d, int64_t row, double since, double h, double l,
                           double r, double *pose, double *heading, const double *seen) {
    rg_place_of at = {pose[0], pose[1], heading[0], heading[1], INFINITY, since};
    if (seen != NULL) {
        const double *there = seen + 4 * row;
        at = (rg_place_of){there[0], there[1], cos(there[2]), sin(there[2]), there[3], since};
    }
    const rg_moved moved = rg_obey(d, &at, h, l, r);
    rg_arc_of(&moved, pose, heading);
}

/* One interval of a log, cut where a delayed command reaches the motors. `arrived` is the row of
 * the command at the motors (first - 1: none yet, the wheels go on as they began); it only moves
 * forward. */
static void rg_replay_interval(const rg_drive *d, const double *t, const double *commands,
                               int64_t first, int64_t row, int64_t *arrived, rg_wheels *wheels,
                               const double *began, double *pose, double *heading,
                               const double *seen) {
    double now = t[row];
    const double end = t[row + 1];
    while (now < end) {
        while (*arrived < row && t[*arrived + 1] + d->latency <= now)
            ++*arrived;
        double until = end;
        if (*arrived < row)
            until = rg_min(end, t[*arrived + 1] + d->latency);
        const double *told = *arrived >= first ? commands + 2 * *arrived : began;
        double turned[2];
        const rg_part part = rg_part_of(d, until - now);
        const double since = now - t[first];
        rg_wheels_advance(d, wheels, told, &part, since, turned);
        if (d->laws == 0)
            rg_arc(d, turned[0], turned[1], pose, heading);
        else
            rg_replay_laws(d, row, since, part.h, turned[0], turned[1], pose, heading, seen);
        now = until;
    }
}

/* Segments that follow one another from the first row to the last. */
static int rg_check_segments(rg_refusal *why, int64_t rows, int32_t segments, const int64_t *start,
                             const double *initial) {
    if (!(rg_within(why, "t", -1, (double)rows, RG_ROWS) &&
          rg_within(why, "start", -1, segments, 0.0, RG_MANY) && rg_there(why, "start", start, 1) &&
          rg_there(why, "initial", initial, segments) &&
          rg_within(why, "start", 0, (double)start[0], 0.0, 0.0)))
        return 0;
    for (int32_t k = 0; k < segments; k++) {
        const double least = (double)start[k] + 1.0;
        const double most = rg_max((double)rows, least); /* the last one says where rows end */
        if (!(rg_within(why, "start", k + 1, (double)start[k + 1], least, most) &&
              rg_within(why, "initial", k, initial[3 * k], RG_DATA) &&
              rg_within(why, "initial", k, initial[3 * k + 1], RG_DATA) &&
              rg_within(why, "initial", k, initial[3 * k + 2], RG_DATA)))
            return 0;
    }
    return rg_within(why, "start", segments, (double)start[segments], (double)rows, (double)rows);
}

/* Which number of a row cannot be used. */
static int32_t rg_refuse_command(rg_refusal *why, int64_t row, double since, double t,
                                 const double *command) {
    if (rg_within(why, "t", row, t, since, DBL_MAX) &&
        rg_within(why, "commands", row, command[0], RG_DATA))
        rg_within(why, "commands", row, command[1], RG_DATA);
    return RG_BAD_ARGUMENT;
}

int32_t rg_replay(const rg_drive *drive, int64_t rows, int32_t segments, const int64_t *start,
                  const double *t, const double *commands, const double *initial,
                  const double *rolling, double *poses, double *speeds, const double *seen,
                  rg_refusal *why) {
    if (rg_check_drive(drive, why) != RG_OK ||
        !rg_check_segments(why, rows, segments, start, initial) || !rg_there(why, "t", t, rows) ||
        !rg_there(why, "commands", commands, rows) || !rg_there(why, "poses", poses, rows))
        return RG_BAD_ARGUMENT;
    for (int32_t k = 0; k < segments; k++) {
        const int64_t first = start[k], last = start[k + 1] - 1;
        double pose[3] = {initial[3 * k], initial[3 * k + 1], initial[3 * k + 2]};
        double heading[2] = {cos(pose[2]), sin(pose[2])};
        double began[2] = {0.0, 0.0};
        for (int side = 0; rolling != NULL && side < 2; side++) {
            began[side] = rolling[2 * k + side];
            if (!rg_within(why, "rolling", k, began[side], RG_DATA))
                return RG_BAD_ARGUMENT;
        }
        rg_wheels wheels = {{began[0], began[1]}, {0.0, 0.0}};
        int64_t arrived = first - 1;
        for (int64_t row = first; row <= last; row++) {
            const double since = row > first ? t[row - 1] : -DBL_MAX;
            if (!(t[row] >= since && t[row] <= DBL_MAX && rg_finite(commands[2 * row]) &&
                  rg_finite(commands[2 * row + 1])))
                return rg_refuse_command(why, row, since, t[row], commands + 2 * row);
            if (row > first)
                rg_replay_interval(drive, t, commands, first, row - 1, &arrived, &wheels, began,
                                   pose, heading, seen);
            for (int i = 0; i < 3; i++)
                poses[3 * row + i] = pose[i];
            if (speeds != NULL) {
                speeds[2 * row] = wheels.speed[0];
                speeds[2 * row + 1] = wheels.speed[1];
            }
            if (!isfinite(pose[0] + pose[1] + pose[2])) {
                *why = (rg_refusal){"poses", row, 0, NAN, -DBL_MAX, DBL_MAX};
                return RG_NOT_FINITE;
            }
        }
    }
    return RG_OK;
}

/* Which number of a row cannot be used. */
static int32_t rg_refuse_row(rg_refusal *why, int64_t row, const double *pose, int32_t scenario,
                             double t) {
    for (int i = 0; i < 3; i++)
        if (!rg_within(why, "poses", row, pose[i], RG_DATA))
            return RG_BAD_ARGUMENT;
    if (rg_within(why, "scenarios", row, scenario, 0.0, RG_SCENARIOS - 1))
        rg_within(why, "t", row, t, RG_ANY);
    return RG_BAD_ARGUMENT;
}

int32_t rg_readings(const rg_model *m, int64_t rows, const double *poses, const int32_t *scenarios,
                    const double *t, double *ps, double *ls, rg_refusal *why) {
    if (rg_check_model(m, why) != RG_OK || !rg_within(why, "poses", -1, (double)rows, RG_ROWS) ||
        !rg_there(why, "poses", poses, rows) || !rg_there(why, "scenarios", scenarios, rows))
        return RG_BAD_ARGUMENT;
    for (int64_t row = 0; row < rows; row++) {
        const double *pose = poses + 3 * row;
        const double time = t == NULL ? 0.0 : t[row];
        const int32_t scenario = scenarios[row];
        if (!(rg_finite(pose[0]) && rg_finite(pose[1]) && rg_finite(pose[2]) && scenario >= 0 &&
              scenario < RG_SCENARIOS && fabs(time) <= RG_MOST))
            return rg_refuse_row(why, row, pose, scenario, time);
        const double c = cos(pose[2]), s = sin(pose[2]);
        if (ps != NULL) {
            double *out = ps + RG_SENSORS * row;
            rg_ps(m, pose[0], pose[1], c, s, out);
            for (int k = 0; k < RG_SENSORS; k++)
                out[k] = rg_min(out[k], m->tables.counts_max);
        }
        if (ls != NULL)
            rg_ls(m, scenario, pose[0], pose[1], c, s, time, ls + RG_SENSORS * row);
    }
    return RG_OK;
}

/* Logged commands through the point model, and what its sensors would have read. */
#include <math.h>
#include <stddef.h>

#include "drive.h"
#include "realitygap_core.h"
#include "sensors.h"

/* One interval of a log, cut where a delayed command reaches the motors. `arrived` is the row of
 * the command at the motors (first - 1: none yet, at rest); it only moves forward. */
static void rg_replay_interval(const rg_drive *d, const double *t, const double *commands,
                               int64_t first, int64_t row, int64_t *arrived, double *speed,
                               double *pose, double *heading) {
    double now = t[row];
    const double end = t[row + 1];
    while (now < end) {
        while (*arrived < row && t[*arrived + 1] + d->latency <= now)
            ++*arrived;
        double until = end;
        if (*arrived < row)
            until = rg_min(end, t[*arrived + 1] + d->latency);
        const int moving = *arrived >= first;
        const double left = moving ? commands[2 * *arrived] : 0.0;
        const double right = moving ? commands[2 * *arrived + 1] : 0.0;
        const rg_part part = rg_part_of(d, until - now);
        const double since = now - t[first];
        const double l = rg_wheel_advance(d, 0, &speed[0], left, &part, since);
        const double r = rg_wheel_advance(d, 1, &speed[1], right, &part, since);
        rg_arc(d, l, r, pose, heading);
        now = until;
    }
}

int32_t rg_replay(const rg_drive *drive, int32_t segments, const int64_t *start, const double *t,
                  const double *commands, const double *initial, double *poses, double *speeds,
                  int64_t *at) {
    for (int32_t k = 0; k < segments; k++) {
        const int64_t first = start[k], last = start[k + 1] - 1;
        double pose[3] = {initial[3 * k], initial[3 * k + 1], initial[3 * k + 2]};
        double heading[2] = {cos(pose[2]), sin(pose[2])};
        double speed[2] = {0.0, 0.0};
        int64_t arrived = first - 1;
        for (int64_t row = first; row <= last; row++) {
            for (int i = 0; i < 3; i++)
                poses[3 * row + i] = pose[i];
            if (speeds != NULL) {
                speeds[2 * row] = speed[0];
                speeds[2 * row + 1] = speed[1];
            }
            if (!isfinite(pose[0] + pose[1] + pose[2])) {
                *at = row;
                return RG_NOT_FINITE;
            }
            if (row < last)
                rg_replay_interval(drive, t, commands, first, row, &arrived, speed, pose, heading);
        }
    }
    return RG_OK;
}

int32_t rg_readings(const rg_model *m, int64_t rows, const double *poses, const int32_t *scenarios,
                    const double *t, double *ps, double *ls, int64_t *at) {
    for (int64_t row = 0; row < rows; row++) {
        const double *pose = poses + 3 * row;
        if (!isfinite(pose[0] + pose[1] + pose[2])) {
            *at = row;
            return RG_NOT_FINITE;
        }
        const double c = cos(pose[2]), s = sin(pose[2]);
        if (ps != NULL) {
            double *out = ps + RG_SENSORS * row;
            rg_ps(m, pose[0], pose[1], c, s, out);
            for (int k = 0; k < RG_SENSORS; k++)
                out[k] = rg_min(out[k], m->tables.counts_max);
        }
        if (ls != NULL)
            rg_ls(m, scenarios[row], pose[0], pose[1], c, s, t == NULL ? 0.0 : t[row],
                  ls + RG_SENSORS * row);
    }
    return RG_OK;
}

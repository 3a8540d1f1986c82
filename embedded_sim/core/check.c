/* What each structure may hold. */
#include "check.h"

/* Can an atom be worked out, whatever its quantity is? */
static int rg_check_atom(rg_refusal *why, const rg_atom *a, int32_t law) {
    const int placed = a->form == RG_SLOPE || a->form == RG_HALF || a->form == RG_DISC;
    const double of = placed ? RG_OF_PLACE : a->of; /* the only quantity that is no number */
    if (!(rg_within(why, "drive.laws form", law, a->form, RG_POWER, RG_OVER) &&
          rg_within(why, "drive.laws of", law, a->of, RG_OF_WHEEL_SPEED, RG_OF_TIME) &&
          rg_within(why, "drive.laws of", law, a->of, of, of) &&
          rg_within(why, "drive.laws of", law, !placed && a->of == RG_OF_PLACE, 0.0, 0.0) &&
          rg_within(why, "drive.laws numbers", law, a->numbers, a->form == RG_CURVE ? 4.0 : 0.0,
                    20.0) &&
          rg_all_within(why, "drive.laws number", a->number, 20, RG_ANY)))
        return 0;
    const double first = a->number[0];
    if (a->form == RG_POWER || a->form == RG_SLOPE || a->form == RG_FADE || a->form == RG_OVER)
        return rg_within(why, "drive.laws scale", law, first, RG_LAW_SCALE) &&
               (a->form != RG_POWER ||
                rg_within(why, "drive.laws exponent", law, a->number[1], RG_LAW_EXPONENT));
    if (a->form == RG_COSINE && a->of == RG_OF_HEADING)
        return rg_within(why, "drive.laws harmonic", law, first, RG_LAW_HARMONIC);
    return a->form != RG_CURVE ||
           rg_within(why, "drive.laws curve", law, a->number[1] - first, RG_LAW_SCALE);
}

static int rg_check_laws(rg_refusal *why, const rg_drive *d) {
    if (!rg_within(why, "drive.laws", -1, d->laws, 0.0, 8.0))
        return 0;
    for (int32_t i = 0; i < d->laws; i++) {
        const rg_law *law = &d->law[i];
        if (!(rg_within(why, "drive.laws channel", i, law->channel, RG_LEFT, RG_ASIDE) &&
              rg_within(why, "drive.laws atoms", i, law->atoms, 1.0, 2.0) &&
              rg_within(why, "drive.laws amplitude", i, law->amplitude, RG_ANY)))
            return 0;
        for (int k = 0; k < law->atoms; k++)
            if (!rg_check_atom(why, &law->atom[k], i))
                return 0;
    }
    return d->laws == 0 || (rg_within(why, "drive.reach", -1, d->reach, RG_WAY) &&
                            rg_within(why, "drive.body", -1, d->body, RG_WAY));
}

static int rg_check_curves(rg_refusal *why, const rg_drive *d) {
    for (int side = 0; side < 2; side++) {
        const int knots = d->knots[side];
        if (!(rg_within(why, "drive.done_curve knots", side, knots, 0.0, 8.0) &&
              rg_within(why, "drive.done_curve knots", side, knots, knots == 0 ? 0.0 : 2.0, 8.0) &&
              rg_all_within(why, "drive.done_curve told", d->told[side], knots, RG_ANY) &&
              rg_all_within(why, "drive.done_curve done", d->done[side], knots, RG_ANY)))
            return 0;
        for (int i = 1; i < knots; i++) {
            const double *told = d->told[side] + i, *done = d->done[side] + i;
            if (!(rg_within(why, "drive.done_curve told", i, told[0] - told[-1], RG_DIVISOR) &&
                  rg_within(why, "drive.done_curve done", i, done[0] - done[-1], RG_NOT_NEGATIVE)))
                return 0;
        }
    }
    return 1;
}

int32_t rg_check_drive(const rg_drive *d, rg_refusal *why) {
    const int good = rg_all_within(why, "drive.wheel_radius", d->wheel_radius, 2, RG_PLACE) &&
                     rg_within(why, "drive.axle", -1, d->axle, RG_LENGTH) &&
                     rg_within(why, "drive.latency", -1, d->latency, RG_NOT_NEGATIVE) &&
                     rg_within(why, "drive.time_constant", -1, d->time_constant, RG_NOT_NEGATIVE) &&
                     rg_all_within(why, "drive.acceleration", d->acceleration, 2, RG_DIVISOR) &&
                     rg_all_within(why, "drive.speed_limit", d->speed_limit, 2, RG_LIMIT) &&
                     rg_all_within(why, "drive.dead_zone", d->dead_zone, 2, RG_LIMIT) &&
                     rg_within(why, "drive.droop_rate", -1, d->droop_rate, RG_ANY) &&
                     rg_within(why, "drive.start_delay", -1, d->start_delay, RG_NOT_NEGATIVE) &&
                     rg_within(why, "drive.turn_first", -1, d->turn_first, RG_LIMIT) &&
                     rg_check_curves(why, d) && rg_check_laws(why, d);
    return good ? RG_OK : RG_BAD_ARGUMENT;
}

/* Are all floats finite? */
static int rg_check_counts(rg_refusal *why, const char *field, const float *counts, int64_t n) {
    int wrong = 0;
    for (int64_t i = 0; i < n; i++)
        wrong |= !(counts[i] - counts[i] == 0.0f);
    for (int64_t i = 0; wrong && i < n; i++)
        if (!rg_within(why, field, i, counts[i], -FLT_MAX, FLT_MAX))
            return 0;
    return 1;
}

/* Axes of at least two nodes, and no table beyond what was given of it. */
static int rg_check_axes(rg_refusal *why, const rg_tables *t) {
    const double most = RG_TABLE_MAX;
    if (!(rg_within(why, "tables.ps_counts", -1, (double)t->ps_floats, 0.0, most) &&
          rg_within(why, "tables.ls_counts", -1, (double)t->ls_floats, 0.0, most) &&
          rg_within(why, "tables.ps_counts distances", -1, t->ps_distances, 2.0, most) &&
          rg_within(why, "tables.ps_counts incidences", -1, t->ps_incidences, 2.0, most) &&
          rg_within(why, "tables.ls_counts distances", -1, t->ls_distances, 2.0, most) &&
          rg_within(why, "tables.ls_counts bearings", -1, t->ls_bearings, 2.0, most)))
        return 0;
    const int64_t ps = (int64_t)RG_SENSORS * t->ps_distances * t->ps_incidences;
    const int64_t ls = t->ls_distances * (3 * (int64_t)t->ls_bearings + 1) + RG_AHEAD;
    return rg_within(why, "tables.ps_counts", -1, (double)ps, 0.0, (double)t->ps_floats) &&
           rg_within(why, "tables.ls_counts", -1, (double)ls, 0.0, (double)t->ls_floats) &&
           rg_there(why, "tables.ps_counts", t->ps_counts, ps) &&
           rg_there(why, "tables.ls_counts", t->ls_counts, ls) &&
           rg_check_counts(why, "tables.ps_counts", t->ps_counts, ps) &&
           rg_check_counts(why, "tables.ls_counts", t->ls_counts, ls);
}

static int rg_check_tables(rg_refusal *why, const rg_tables *t) {
    return rg_check_axes(why, t) && rg_within(why, "tables.ps_range", -1, t->ps_range, RG_LENGTH) &&
           rg_all_within(why, "tables.ps_noise", t->ps_noise, RG_SENSORS, RG_NOT_NEGATIVE) &&
           rg_within(why, "tables.ps_noise_floor", -1, t->ps_noise_floor, RG_NOT_NEGATIVE) &&
           rg_within(why, "tables.ls_range", -1, t->ls_range, RG_LENGTH) &&
           rg_all_within(why, "tables.ls_dark", t->ls_dark, RG_SENSORS, RG_ANY) &&
           rg_within(why, "tables.ls_noise", -1, t->ls_noise, RG_NOT_NEGATIVE) &&
           rg_within(why, "tables.counts_max", -1, t->counts_max, RG_NOT_NEGATIVE);
}

/* Can a robot move, and is there a place for food outside the nest? */
static int rg_check_places(rg_refusal *why, const rg_model *m) {
    if (!(rg_within(why, "body_radius", -1, m->body_radius, RG_WAY) &&
          rg_within(why, "arena_radius", -1, m->arena_radius, RG_LENGTH) &&
          rg_within(why, "nest.x", -1, m->nest_x, RG_PLACE) &&
          rg_within(why, "nest.y", -1, m->nest_y, RG_PLACE) &&
          rg_within(why, "food_radius", -1, m->food_radius, RG_WAY) &&
          rg_within(why, "food_items", -1, m->food_items, 0.0, RG_FOOD_MAX)))
        return 0;
    const double reach = m->arena_radius - m->body_radius;
    const double far = sqrt(m->nest_x * m->nest_x + m->nest_y * m->nest_y) + reach;
    const double least = nextafter(m->body_radius, RG_FAR);
    return rg_within(why, "arena_radius", -1, m->arena_radius, least, RG_FAR) &&
           rg_within(why, "nest.radius", -1, m->nest_radius, 0.0, nextafter(far, 0.0));
}

static int rg_check_lamps(rg_refusal *why, const rg_model *m) {
    return rg_all_within(why, "lamps.x", m->lamp_x, RG_SCENARIOS, RG_PLACE) &&
           rg_all_within(why, "lamps.y", m->lamp_y, RG_SCENARIOS, RG_PLACE) &&
           rg_within(why, "lamp_gain", -1, m->lamp_gain, RG_ANY) &&
           rg_within(why, "senses.lamp_decay", -1, m->lamp_decay, RG_ANY) &&
           rg_within(why, "senses.second_lamp.x", -1, m->second_x, RG_PLACE) &&
           rg_within(why, "senses.second_lamp.y", -1, m->second_y, RG_PLACE) &&
           rg_within(why, "senses.second_lamp.intensity", -1, m->second_gain, RG_ANY);
}

int32_t rg_check_model(const rg_model *m, rg_refusal *why) {
    const int32_t drive = rg_check_drive(&m->drive, why);
    if (drive != RG_OK)
        return drive;
    const double late = (RG_COMMAND_SLOTS - 2) * m->control_step;
    const int good =
        rg_within(why, "control_step", -1, m->control_step, RG_CONTROL_STEP) &&
        rg_within(why, "drive.latency", -1, m->drive.latency, 0.0, late) &&
        rg_check_places(why, m) && rg_check_tables(why, &m->tables) && rg_check_lamps(why, m) &&
        rg_all_within(why, "sensor_angles", m->sensor_angle, RG_SENSORS, -RG_PI, RG_PI) &&
        rg_all_within(why, "sensor_cos", m->sensor_cos, RG_SENSORS, RG_SHARE) &&
        rg_all_within(why, "sensor_sin", m->sensor_sin, RG_SENSORS, RG_SHARE) &&
        rg_all_within(why, "senses.ps_gain", m->ps_gain, RG_SENSORS, RG_ANY) &&
        rg_all_within(why, "senses.ps_offset", m->ps_offset, RG_SENSORS, RG_ANY) &&
        rg_all_within(why, "senses.ls_gain", m->ls_gain, RG_SENSORS, RG_ANY);
    return good ? RG_OK : RG_BAD_ARGUMENT;
}

int32_t rg_check_behaviour(const rg_behaviour *b, rg_refusal *why) {
    const double step = b->control_step, longest = RG_STEPS_MAX * step;
    const double shortest = b->search_duration[0];
    const int good =
        rg_within(why, "behaviour.control_step", -1, step, RG_CONTROL_STEP) &&
        rg_within(why, "behaviour.cruise_speed", -1, b->cruise_speed, RG_ANY) &&
        rg_all_within(why, "behaviour.avoid_threshold", b->avoid_threshold, RG_SENSORS,
                      RG_DIVISOR) &&
        rg_within(why, "behaviour.avoid_speed", -1, b->avoid_speed, RG_ANY) &&
        rg_within(why, "behaviour.avoid_duration", -1, b->avoid_duration, 0.0, longest) &&
        rg_within(why, "behaviour.avoid_memory", -1, b->avoid_memory, 0.0, longest) &&
        rg_within(why, "behaviour.search_curvature", -1, b->search_curvature, RG_ANY) &&
        rg_within(why, "behaviour.search_duration", 0, shortest, step, longest) &&
        rg_within(why, "behaviour.search_duration", 1, b->search_duration[1], shortest, longest) &&
        rg_within(why, "behaviour.light_contrast", -1, b->light_contrast, RG_LIMIT) &&
        rg_within(why, "behaviour.light_gain", -1, b->light_gain, RG_ANY) &&
        rg_within(why, "behaviour.light_search", -1, b->light_search, RG_ANY) &&
        rg_all_within(why, "behaviour.sensor_cos", b->sensor_cos, RG_SENSORS, RG_SHARE) &&
        rg_all_within(why, "behaviour.sensor_sin", b->sensor_sin, RG_SENSORS, RG_SHARE);
    return good ? RG_OK : RG_BAD_ARGUMENT;
}

/* Runs every entry of the core under the sanitizers, at its usual and at its extreme settings. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "realitygap_core.h"

enum { DISTANCES = 16, INCIDENCES = 5, BEARINGS = 24, TRIALS = 27, STEPS = 1500 };

static void build_model(rg_model *m, float *ps, float *ls) {
    const double angles[8] = {-0.297, -0.855, -1.571, -2.618, 2.618, 1.571, 0.855, 0.297};
    memset(m, 0, sizeof *m);
    for (int i = 0; i < 8 * DISTANCES * INCIDENCES; i++)
        ps[i] = (float)(3600 - i % (DISTANCES * INCIDENCES) * 40);
    for (int i = 0; i < DISTANCES * (3 * BEARINGS + 1); i++)
        ls[i] = (float)(i % BEARINGS * 30);
    for (int side = 0; side < 2; side++) {
        m->drive.wheel_radius[side] = 0.0205;
        m->drive.acceleration[side] = m->drive.speed_limit[side] = INFINITY;
    }
    m->drive.axle = 0.053;
    m->drive.turn_first = INFINITY;
    m->tables = (rg_tables){.ps_counts = ps,
                            .ps_floats = 8 * DISTANCES * INCIDENCES,
                            .ps_distances = DISTANCES,
                            .ps_incidences = INCIDENCES,
                            .ps_range = 0.15,
                            .ps_noise_floor = 3.0,
                            .ls_counts = ls,
                            .ls_floats = DISTANCES * (3 * BEARINGS + 1) + RG_AHEAD,
                            .ls_distances = DISTANCES,
                            .ls_bearings = BEARINGS,
                            .ls_range = 1.2,
                            .ls_noise = 9.0,
                            .counts_max = 4095.0};
    m->body_radius = 0.035;
    m->arena_radius = 0.6;
    m->nest_x = 0.5;
    m->nest_radius = 0.2;
    m->food_radius = 0.05;
    m->food_items = RG_FOOD_MAX;
    m->lamp_on[0] = m->lamp_on[2] = 1;
    m->lamp_x[0] = -0.6;
    m->lamp_x[2] = 0.6;
    m->lamp_gain = 1.0;
    m->control_step = 0.04;
    for (int k = 0; k < RG_SENSORS; k++) {
        m->sensor_angle[k] = angles[k];
        m->sensor_cos[k] = cos(angles[k]);
        m->sensor_sin[k] = sin(angles[k]);
        m->ps_gain[k] = m->ls_gain[k] = 1.0;
        m->tables.ps_noise[k] = 0.25;
        m->tables.ls_dark[k] = 4035.0;
    }
}

static void build_behaviour(rg_behaviour *b, const rg_model *m) {
    memset(b, 0, sizeof *b);
    b->cruise_speed = 6.0;
    b->avoid_speed = 4.0;
    b->avoid_duration = b->avoid_memory = 0.5;
    b->search_curvature = 1.0;
    b->search_duration[0] = 0.4;
    b->search_duration[1] = 2.0;
    b->light_contrast = 40.0;
    b->light_gain = 1.2;
    b->light_search = 0.5;
    b->control_step = 0.04;
    for (int k = 0; k < RG_SENSORS; k++) {
        b->avoid_threshold[k] = k == 0 || k == 7 ? 200.0 : INFINITY;
        b->sensor_cos[k] = m->sensor_cos[k];
        b->sensor_sin[k] = m->sensor_sin[k];
    }
}

static void fail(const char *what, int status) {
    fprintf(stderr, "%s: status %d\n", what, status);
    exit(1);
}

static void evaluate(const rg_model *m, const rg_behaviour *b, int expected) {
    double genomes[2 * TRIALS], fitness[TRIALS];
    int32_t scenarios[TRIALS], deposits[TRIALS];
    rg_refusal why;
    uint32_t seeds[4 * TRIALS];
    for (int i = 0; i < TRIALS; i++) {
        genomes[2 * i] = 0.33 * (i % 3) + 0.1;
        genomes[2 * i + 1] = 0.33 * (i / 3 % 3) + 0.1;
        scenarios[i] = i / 9;
        for (int k = 0; k < 4; k++)
            seeds[4 * i + k] = i == 0 ? 0u : (uint32_t)(4 * i + k) * 2654435761u;
    }
    rg_behaviour own[TRIALS];
    for (int i = 0; i < TRIALS; i++) {
        own[i] = *b;
        own[i].cruise_speed = 1.0 + 0.2 * i;
        own[i].search_curvature = 0.1 * i;
    }
    rg_trials set = {STEPS, TRIALS, 0, genomes, scenarios, seeds, own, fitness, deposits};
    for (int pass = 0; pass < 8; pass++) {
        set.behaviours = pass & 1 ? own : NULL;
        set.form = pass / 2;
        if (!rg_has_form(set.form))
            continue;
        const int status = rg_evaluate(m, b, &set, &why);
        if (status != expected)
            fail("evaluate", status);
        for (int i = 0; status == RG_OK && i < TRIALS; i++)
            if (!(fitness[i] >= 0.0 && fitness[i] <= 60.0 * STEPS))
                fail("fitness", i);
    }
}

static void replay(const rg_model *m) {
    enum { ROWS = 300 };
    double t[ROWS], commands[2 * ROWS], poses[3 * ROWS], speeds[2 * ROWS];
    double ps[8 * ROWS], ls[8 * ROWS];
    int32_t scenarios[ROWS];
    rg_refusal why;
    const int64_t start[4] = {0, 1, 100, ROWS};
    const double initial[9] = {0.0};
    for (int i = 0; i < ROWS; i++) {
        t[i] = 0.05 * i + 0.01 * (i % 3);
        commands[2 * i] = 6.0 * sin(i);
        commands[2 * i + 1] = 6.0 * cos(2.0 * i);
        scenarios[i] = i % 3;
    }
    rg_drive late = m->drive;
    late.latency = 0.333;
    late.time_constant = 0.05;
    late.turn_first = 4.0;
    late.start_delay = 0.17;
    late.knots[0] = 2;
    late.told[0][1] = late.done[0][1] = 5.0;
    late.acceleration[0] = late.acceleration[1] = 50.0;
    const rg_drive *drives[2] = {&m->drive, &late};
    for (int i = 0; i < 2; i++) {
        int status = rg_replay(drives[i], ROWS, 3, start, t, commands, initial, NULL, poses, speeds,
                               NULL, &why);
        if (status == RG_OK)
            status = rg_readings(m, ROWS, poses, scenarios, t, ps, ls, &why);
        if (status != RG_OK)
            fail("replay", status);
    }
    commands[2 * 50] = NAN;
    if (rg_replay(&m->drive, ROWS, 3, start, t, commands, initial, NULL, poses, NULL, NULL, &why) !=
            RG_BAD_ARGUMENT ||
        why.index != 50)
        fail("replay of NaN", (int)why.index);
    commands[2 * 50] = 1e308;
    if (rg_replay(&m->drive, ROWS, 3, start, t, commands, initial, NULL, poses, NULL, NULL, &why) !=
            RG_NOT_FINITE ||
        why.index != 51)
        fail("replay beyond the numbers", (int)why.index);
    poses[3 * 51] = NAN;
    if (rg_readings(m, ROWS, poses, scenarios, NULL, ps, NULL, &why) != RG_BAD_ARGUMENT)
        fail("readings at NaN", (int)why.index);
}

static void swarm(const rg_behaviour *b) {
    enum { ROBOTS = 5 };
    rg_controller controllers[ROBOTS];
    rg_behaviour own[ROBOTS];
    const uint32_t seed[4] = {1, 2, 3, 4};
    double genomes[2 * ROBOTS], ps[8 * ROBOTS] = {0}, ls[8 * ROBOTS] = {0}, commands[2 * ROBOTS];
    uint8_t active[ROBOTS], food[ROBOTS], nest[ROBOTS], picked[ROBOTS], dropped[ROBOTS];
    for (int i = 0; i < ROBOTS; i++) {
        rg_controller_start(&controllers[i], seed);
        own[i] = *b;
        genomes[2 * i] = genomes[2 * i + 1] = 0.2 * i;
        active[i] = i > 0;
    }
    for (int step = 0; step < 500; step++) {
        for (int i = 0; i < ROBOTS; i++) {
            food[i] = (uint8_t)(step % 7 == i);
            nest[i] = (uint8_t)(step % 11 == i);
            ls[8 * i + step % 8] = step;
            ps[8 * i + step % 8] = step % 50 == 0 ? 1e4 : 0.0;
        }
        rg_refusal why;
        const int status = rg_control_swarm(own, ROBOTS, active, genomes, controllers, ps, ls, food,
                                            nest, commands, picked, dropped, &why);
        if (status != RG_OK)
            fail("control", status);
    }
}

int main(void) {
    static float ps[8 * DISTANCES * INCIDENCES], ls[DISTANCES * (3 * BEARINGS + 1) + RG_AHEAD];
    rg_model model;
    rg_behaviour behaviour;
    build_model(&model, ps, ls);
    build_behaviour(&behaviour, &model);
    evaluate(&model, &behaviour, RG_OK);
    replay(&model);
    swarm(&behaviour);
    model.drive.latency = (RG_COMMAND_SLOTS - 2) * model.control_step;
    model.drive.time_constant = 0.1;
    model.drive.dead_zone[0] = 1.0;
    model.drive.speed_limit[1] = 5.0;
    model.lamp_x[2] = 3.0; /* further than the table knows */
    model.lamp_decay = 0.1;
    model.second_gain = 2.0;
    model.ps_offset[3] = 50.0;
    evaluate(&model, &behaviour, RG_OK);
    /* what once read beyond the light's table, or drew places without end */
    model.nest_radius = 1.0649999999;
    evaluate(&model, &behaviour, RG_NO_ROOM);
    model.nest_radius = 2.0;
    evaluate(&model, &behaviour, RG_BAD_ARGUMENT);
    model.nest_radius = 0.2;
    model.sensor_angle[3] = -2.618 - 6.2;
    evaluate(&model, &behaviour, RG_BAD_ARGUMENT);
    model.sensor_angle[3] = 1e6;
    evaluate(&model, &behaviour, RG_BAD_ARGUMENT);
    model.sensor_angle[3] = -2.618;
    model.arena_radius = 0.03;
    evaluate(&model, &behaviour, RG_BAD_ARGUMENT);
    model.arena_radius = 0.6;
    model.tables.ls_floats--;
    evaluate(&model, &behaviour, RG_BAD_ARGUMENT);
    model.tables.ls_floats++;
    model.food_items = RG_FOOD_MAX + 1;
    evaluate(&model, &behaviour, RG_BAD_ARGUMENT);
    model.food_items = 7;
    model.drive.wheel_radius[0] = NAN;
    evaluate(&model, &behaviour, RG_BAD_ARGUMENT);
    model.drive.wheel_radius[0] = 0.0205;
    behaviour.light_gain = NAN;
    evaluate(&model, &behaviour, RG_BAD_ARGUMENT);
    puts("the core ran clean under the sanitizers");
    return 0;
}

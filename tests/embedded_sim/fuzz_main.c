/* Random structures against every entry of the core, under the sanitizers.
 *
 * A call is built from bytes: valid structures, then some of their numbers replaced by extreme
 * ones. It must end with a status; what is not OK says why; what is OK is finite, and the same to
 * the bit in every form. Arrays have exactly the length that is said, so that a read beyond one is
 * seen. Every answer takes a bounded time: at most 40 trials of 60 steps, or 40 rows.
 *
 * `fuzz_main CALLS [SEED]` draws the bytes; LLVMFuzzerTestOneInput takes them from a fuzzer: build
 * with clang -fsanitize=fuzzer,address,undefined -DRG_FUZZER. */
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "random.h"
#include "realitygap_core.h"

enum { BYTES = 1024, STATUSES = 4, ENTRIES = 4 };

/* Bytes still to be read; zeros after the last. */
typedef struct {
    const uint8_t *data;
    size_t left;
} bytes;

static uint64_t take(bytes *from, int count) {
    uint64_t value = 0;
    for (int i = 0; i < count && from->left > 0; i++, from->left--)
        value = value << 8 | *from->data++;
    return value;
}

static int below(bytes *from, int limit) { return (int)(take(from, 2) % (uint64_t)limit); }

static double uniform(bytes *from, double low, double high) {
    return low + (high - low) * (double)take(from, 4) * 0x1p-32;
}

/* A number that is far out, on an edge, or no number. */
static double extreme(bytes *from, double was) {
    static const double edges[] = {
        0.0,     -0.0,      1.0,   -1.0,  NAN,    INFINITY, -INFINITY,    DBL_MAX,      -DBL_MAX,
        DBL_MIN, 0x1p-1074, 1e300, 1e155, 1e-155, 1e12,     1.0649999999, 3.1415926536, -3.2,
        6.3,     1e4,       -1e4,  1e-9,  1e6,    0x1p31,   0x1p53,       0.565,        0.04};
    const int kind = below(from, 6);
    if (kind == 0) { /* any bits at all */
        const uint64_t bits = take(from, 8);
        double any;
        memcpy(&any, &bits, sizeof any);
        return any;
    }
    if (kind == 1)
        return was * uniform(from, -2.0, 2.0);
    if (kind == 2)
        return nextafter(was, uniform(from, -1.0, 1.0) * DBL_MAX);
    return edges[below(from, sizeof edges / sizeof *edges)];
}

static int32_t extreme_whole(bytes *from) {
    static const int32_t edges[] = {0, 1, -1, 2, 3, 31, 33, 64, 1 << 20, INT32_MAX, INT32_MIN};
    const int edge = below(from, 1 + sizeof edges / sizeof *edges);
    return edge == 0 ? (int32_t)take(from, 4) : edges[edge - 1];
}

/* Replace some numbers of a structure: its doubles, or its whole numbers of 32 bits. */
static void perturb(bytes *from, void *structure, size_t size) {
    for (int n = below(from, 8) - 5; n > 0; n--) { /* most often none: it has to be valid, too */
        uint8_t *at = (uint8_t *)structure + 8 * (take(from, 2) % (size / 8));
        if (below(from, 4) == 0) {
            const int32_t whole = extreme_whole(from);
            memcpy(at + 4 * below(from, 2), &whole, sizeof whole);
            continue;
        }
        double number;
        memcpy(&number, at, sizeof number);
        number = extreme(from, number);
        memcpy(at, &number, sizeof number);
    }
}

static void fail(const char *what, int32_t status, const rg_refusal *why) {
    fprintf(stderr, "%s: status %d, %s[%lld] got %g\n", what, status, why->field ? why->field : "",
            (long long)why->index, why->got);
    abort();
}

static long calls[ENTRIES][STATUSES];

/* Every status is known, and what is not OK says why. */
static int32_t ended(int entry, int32_t status, const rg_refusal *why) {
    if (status < 0 || status >= STATUSES ||
        (status != RG_OK && (why->field == NULL || why->low > why->high)))
        fail("status", status, why);
    calls[entry][status]++;
    return status;
}

static void *array(size_t count, size_t size) { return malloc(count * size); }

static double *numbers(bytes *from, int count, double low, double high) {
    double *values = array((size_t)count, sizeof *values);
    for (int i = 0; i < count; i++)
        values[i] = uniform(from, low, high);
    if (count > 0 && below(from, 8) == 0)
        values[below(from, count)] = extreme(from, 1.0);
    return values;
}

static float *counts(bytes *from, int64_t count, float most) {
    float *values = array((size_t)count, sizeof *values);
    const uint64_t step = 1 + take(from, 2);
    for (int64_t i = 0; i < count; i++)
        values[i] = most * (float)((uint64_t)i * step % 4096) * 0x1p-12f;
    if (below(from, 8) == 0)
        values[(int64_t)take(from, 4) % count] = (float)extreme(from, 1.0);
    return values;
}

static void build_law(bytes *from, rg_law *law) {
    law->channel = below(from, RG_ASIDE + 1);
    law->atoms = 1 + below(from, 2);
    law->amplitude = uniform(from, -0.5, 0.5);
    for (int k = 0; k < law->atoms; k++) {
        rg_atom *a = &law->atom[k];
        a->form = below(from, RG_OVER + 1);
        a->of = a->form >= RG_SLOPE && a->form <= RG_DISC ? RG_OF_PLACE : below(from, RG_OF_PLACE);
        a->numbers = 4 + below(from, 17);
        for (int i = 0; i < 20; i++)
            a->number[i] = uniform(from, 0.1, 3.0);
        a->number[1] = a->number[0] + uniform(from, 0.1, 2.0);
    }
}

static void build_drive(bytes *from, rg_drive *d) {
    memset(d, 0, sizeof *d);
    for (int side = 0; side < 2; side++) {
        d->wheel_radius[side] = uniform(from, 0.01, 0.03);
        d->acceleration[side] = below(from, 2) ? INFINITY : uniform(from, 5.0, 200.0);
        d->speed_limit[side] = below(from, 2) ? INFINITY : uniform(from, 1.0, 12.0);
    }
    d->axle = uniform(from, 0.03, 0.06);
    d->latency = below(from, 2) ? 0.0 : uniform(from, 0.0, 2.4);
    d->time_constant = below(from, 2) ? 0.0 : uniform(from, 0.0, 0.3);
    for (int side = 0; side < 2; side++) {
        d->knots[side] = below(from, 2) ? 0 : 2 + below(from, 7);
        for (int i = 0; i < d->knots[side]; i++) {
            d->told[side][i] = 2.0 * (i - 4) + uniform(from, 0.0, 1.0);
            d->done[side][i] = 2.0 * (i - 4) + uniform(from, 0.0, 1.0);
        }
    }
    d->start_delay = below(from, 2) ? 0.0 : uniform(from, 0.0, 0.5);
    d->turn_first = below(from, 2) ? INFINITY : uniform(from, 1.0, 12.0);
    d->reach = 0.565;
    d->body = 0.035;
    d->laws = below(from, 2) ? 0 : below(from, 4);
    for (int i = 0; i < d->laws; i++)
        build_law(from, &d->law[i]);
    perturb(from, d, offsetof(rg_drive, law));
    if (d->laws > 0 && d->laws <= 8)
        perturb(from, d->law, (size_t)d->laws * sizeof *d->law);
}

/* The tables' memory is the caller's to free. */
static void build_model(bytes *from, rg_model *m) {
    memset(m, 0, sizeof *m);
    rg_tables *t = &m->tables;
    t->ps_distances = 2 + below(from, 8);
    t->ps_incidences = 2 + below(from, 6);
    t->ls_distances = 2 + below(from, 8);
    t->ls_bearings = 2 + below(from, 40);
    t->ps_range = 0.15;
    t->ps_noise_floor = 3.0;
    t->ls_range = 1.2;
    t->ls_noise = 9.0;
    t->counts_max = 4095.0;
    m->body_radius = 0.035;
    m->arena_radius = 0.6;
    m->nest_x = 0.5;
    m->nest_radius = below(from, 8) ? 0.2 : 1.0649999999;
    m->food_radius = 0.05;
    m->food_items = below(from, RG_FOOD_MAX + 1);
    m->lamp_on[0] = m->lamp_on[2] = 1;
    m->lamp_x[0] = -0.6;
    m->lamp_x[2] = 0.6;
    m->lamp_gain = 1.0;
    m->second_gain = below(from, 2) ? 0.0 : 0.5;
    m->control_step = 0.04;
    for (int k = 0; k < RG_SENSORS; k++) {
        m->sensor_angle[k] = uniform(from, -3.14, 3.14);
        m->sensor_cos[k] = cos(m->sensor_angle[k]);
        m->sensor_sin[k] = sin(m->sensor_angle[k]);
        m->ps_gain[k] = m->ls_gain[k] = 1.0;
        t->ps_noise[k] = 0.25;
        t->ls_dark[k] = 4035.0;
    }
    build_drive(from, &m->drive);
    const int64_t ps = (int64_t)RG_SENSORS * t->ps_distances * t->ps_incidences;
    const int64_t ls = (int64_t)t->ls_distances * (3 * t->ls_bearings + 1) + RG_AHEAD;
    perturb(from, m, sizeof *m);
    /* pointers and how long what they point to is stay true: the binding sees to it */
    t->ps_counts = counts(from, ps, 3600.0f);
    t->ls_counts = counts(from, ls, 3000.0f);
    t->ps_floats = ps;
    t->ls_floats = ls;
}

static void build_behaviour(bytes *from, rg_behaviour *b) {
    memset(b, 0, sizeof *b);
    b->cruise_speed = uniform(from, 1.0, 8.0);
    b->avoid_speed = 4.0;
    b->avoid_duration = b->avoid_memory = 0.5;
    b->search_curvature = uniform(from, 0.0, 2.0);
    b->search_duration[0] = 0.4;
    b->search_duration[1] = 2.0;
    b->light_contrast = 40.0;
    b->light_gain = 1.2;
    b->light_search = 0.5;
    b->control_step = 0.04;
    for (int k = 0; k < RG_SENSORS; k++) {
        b->avoid_threshold[k] = k < 2 || k > 5 ? uniform(from, 20.0, 400.0) : INFINITY;
        b->sensor_cos[k] = cos(0.3 + 0.75 * k);
        b->sensor_sin[k] = -sin(0.3 + 0.75 * k);
    }
    perturb(from, b, sizeof *b);
}

static void evaluate(bytes *from) {
    rg_model m;
    rg_behaviour b, *own = NULL;
    build_model(from, &m);
    build_behaviour(from, &b);
    const int trials = below(from, 41);
    rg_trials set = {.steps = below(from, 61), .trials = trials, .form = below(from, 4)};
    double *genomes = numbers(from, 2 * trials, 0.0, 0.99);
    int32_t *scenarios = array((size_t)trials, sizeof *scenarios);
    uint32_t *seeds = array(4 * (size_t)trials, sizeof *seeds);
    for (int i = 0; i < trials; i++)
        scenarios[i] = below(from, 64) ? below(from, 3) : extreme_whole(from);
    for (int i = 0; i < 4 * trials; i++)
        seeds[i] = (uint32_t)take(from, 1) * 2654435761u + (uint32_t)i;
    if (below(from, 8) == 0) {
        own = array((size_t)trials, sizeof *own);
        for (int i = 0; i < trials; i++)
            own[i] = b;
    }
    double *fitness[2];
    int32_t *deposits[2], status[2];
    set.genomes = genomes, set.scenarios = scenarios, set.seeds = seeds, set.behaviours = own;
    if (below(from, 16) == 0)
        set.steps = below(from, 2) ? INT32_MAX : INT32_MIN;
    if (below(from, 16) == 0)
        set.trials = below(from, 2) ? INT32_MAX : -1;
    if (below(from, 16) == 0)
        set.form = extreme_whole(from);
    if (below(from, 32) == 0)
        set.genomes = NULL;
    for (int way = 0; way < 2; way++) {
        rg_refusal why = {0};
        set.fitness = fitness[way] = calloc((size_t)trials + 1, sizeof **fitness);
        set.deposits = deposits[way] = calloc((size_t)trials + 1, sizeof **deposits);
        status[way] = ended(0, rg_evaluate(&m, &b, &set, &why), &why);
        for (int i = 0; i < trials; i++)
            if (!isfinite(fitness[way][i]))
                fail("fitness", i, &why);
        if (rg_has_form(set.form) && set.form >= 0 && set.form < 4)
            set.form = set.form == RG_ONE_BY_ONE ? RG_BEST : RG_ONE_BY_ONE;
    }
    rg_refusal none = {0};
    if (status[0] != status[1])
        fail("another form ended otherwise", status[1], &none);
    if (status[0] == RG_OK &&
        (memcmp(fitness[0], fitness[1], (size_t)trials * sizeof **fitness) != 0 ||
         memcmp(deposits[0], deposits[1], (size_t)trials * sizeof **deposits) != 0))
        fail("another form has other bits", status[0], &none);
    for (int way = 0; way < 2; way++)
        free(fitness[way]), free(deposits[way]);
    free(genomes), free(scenarios), free(seeds), free(own);
    free((void *)m.tables.ps_counts), free((void *)m.tables.ls_counts);
}

static void replay(bytes *from) {
    rg_drive drive;
    build_drive(from, &drive);
    const int segments = below(from, 5), each = 1 + below(from, 10), rows = segments * each;
    int64_t *start = array((size_t)segments + 1, sizeof *start);
    for (int k = 0; k <= segments; k++)
        start[k] = k * each;
    if (below(from, 8) == 0)
        start[below(from, segments + 1)] = below(from, 2) ? extreme_whole(from) : INT64_MIN;
    double *t = array((size_t)rows, sizeof *t), now = 0.0;
    for (int i = 0; i < rows; i++)
        t[i] = now += i % each ? uniform(from, 0.0, 0.3) : -5.0;
    if (rows > 0 && below(from, 4) == 0)
        t[below(from, rows)] = extreme(from, 1.0);
    double *commands = numbers(from, 2 * rows, -6.0, 6.0);
    double *initial = numbers(from, 3 * segments, -1.0, 1.0);
    double *poses = array(3 * (size_t)rows, sizeof *poses);
    double *speeds = below(from, 2) ? array(2 * (size_t)rows, sizeof *speeds) : NULL;
    rg_refusal why = {0};
    const int32_t other = extreme_whole(from); /* more than there are would be the caller's lie */
    const int64_t said = below(from, 16) == 0 && other < rows ? other : rows;
    const int32_t status = ended(1,
                                 rg_replay(&drive, said, segments, start, t, commands, initial,
                                           NULL, poses, speeds, NULL, &why),
                                 &why);
    for (int i = 0; status == RG_OK && i < 3 * rows; i++)
        if (!isfinite(poses[i]))
            fail("pose", i, &why);
    free(start), free(t), free(commands), free(initial), free(poses), free(speeds);
}

static void readings(bytes *from) {
    rg_model m;
    build_model(from, &m);
    const int rows = below(from, 41);
    double *poses = numbers(from, 3 * rows, -0.6, 0.6), *t = NULL;
    if (below(from, 2))
        t = numbers(from, rows, 0.0, 1000.0);
    int32_t *scenarios = array((size_t)rows, sizeof *scenarios);
    for (int i = 0; i < rows; i++)
        scenarios[i] = below(from, 64) ? below(from, 3) : extreme_whole(from);
    double *ps = array(8 * (size_t)rows, sizeof *ps), *ls = array(8 * (size_t)rows, sizeof *ls);
    rg_refusal why = {0};
    const int64_t said = below(from, 16) ? rows : -1 - below(from, 3);
    const int32_t status = ended(2, rg_readings(&m, said, poses, scenarios, t, ps, ls, &why), &why);
    for (int i = 0; status == RG_OK && i < 8 * rows; i++)
        if (!isfinite(ps[i]) || !isfinite(ls[i]))
            fail("reading", i, &why);
    free(poses), free(t), free(scenarios), free(ps), free(ls);
    free((void *)m.tables.ps_counts), free((void *)m.tables.ls_counts);
}

static void swarm(bytes *from) {
    const int robots = below(from, 8);
    const size_t all = (size_t)robots;
    rg_behaviour *own = array(all, sizeof *own);
    rg_controller *controllers = array(all, sizeof *controllers);
    double *genomes = numbers(from, 2 * robots, 0.0, 0.99);
    double *ps = numbers(from, 8 * robots, 0.0, 500.0),
           *ls = numbers(from, 8 * robots, 0.0, 4095.0);
    double *commands = array(2 * all, sizeof *commands);
    uint8_t *flags[5];
    for (int k = 0; k < 5; k++) {
        flags[k] = array(all, 1);
        for (int i = 0; i < robots; i++)
            flags[k][i] = (uint8_t)(take(from, 1) & 3);
    }
    for (int i = 0; i < robots; i++) {
        const uint32_t seed[4] = {(uint32_t)take(from, 2), 0, 0, 0};
        rg_controller_start(&controllers[i], seed);
        build_behaviour(from, &own[i]);
        if (below(from, 16) == 0)
            perturb(from, &controllers[i], sizeof controllers[i]);
    }
    rg_refusal why = {0};
    for (int step = 0; step < 3; step++) {
        const int32_t said = below(from, 32) ? robots : -1 - below(from, 3);
        const int32_t status =
            ended(3,
                  rg_control_swarm(own, said, flags[0], genomes, controllers, ps, ls, flags[1],
                                   flags[2], commands, flags[3], flags[4], &why),
                  &why);
        for (int i = 0; status == RG_OK && i < 2 * robots; i++)
            if (isnan(commands[i]))
                fail("command", i, &why);
    }
    for (int k = 0; k < 5; k++)
        free(flags[k]);
    free(own), free(controllers), free(genomes), free(ps), free(ls), free(commands);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static void (*const entries[ENTRIES])(bytes *) = {evaluate, replay, readings, swarm};
    bytes from = {data, size};
    entries[below(&from, ENTRIES)](&from);
    return 0;
}

#ifndef RG_FUZZER
int main(int count, char **words) {
    const long wanted = count > 1 ? atol(words[1]) : 1000;
    const uint32_t first = count > 2 ? (uint32_t)atol(words[2]) : 1;
    static const char *const names[ENTRIES] = {"evaluate", "replay", "readings", "control"};
    uint8_t data[BYTES];
    for (long call = 0; call < wanted; call++) {
        rg_random random;
        const uint32_t seed[4] = {first, (uint32_t)call, 0x9e3779b9u, 1};
        rg_seed(&random, seed);
        for (int i = 0; i < 20; i++) /* seeds differ in few bits */
            rg_next(&random);
        for (int i = 0; i < BYTES; i++)
            data[i] = (uint8_t)(rg_next(&random) >> 24);
        LLVMFuzzerTestOneInput(data, BYTES);
    }
    for (int k = 0; k < ENTRIES; k++)
        printf("%s: %ld fine, %ld not finite, %ld refused, %ld without room\n", names[k],
               calls[k][RG_OK], calls[k][RG_NOT_FINITE], calls[k][RG_BAD_ARGUMENT],
               calls[k][RG_NO_ROOM]);
    return 0;
}
#endif

/* The point-model simulator a robot carries on its board, and the controller both worlds run.
 *
 * Conventions: SI units and REP-103 (x forward, yaw counter-clockwise, radians). A constant model,
 * a mutable state, no globals, no allocation: every array belongs to the caller. Wheel and side
 * pairs are ordered left, right. Infrared and light sensors are ordered as on the e-puck: clockwise
 * from front-right (ps0) to front-left (ps7).
 *
 * The part between the two marks is read by the Python binding as it stands: plain C declarations,
 * no preprocessor lines.
 */
#ifndef REALITYGAP_CORE_H
#define REALITYGAP_CORE_H

#include <stdint.h>

/* binding begin */

enum {
    RG_SENSORS = 8,   /* infrared and light sensors of an e-puck */
    RG_SCENARIOS = 3, /* light opposite the nest, no light, light at the nest (paper, Fig. 5) */
    RG_AHEAD = 64,    /* floats that the light's table is longer than its rows */
    RG_FOOD_MAX = 32, /* most food items a foraging state can hold */
    RG_COMMAND_SLOTS =
        64, /* commands on their way to the motors: at 40 ms, up to 2.5 s of latency */
    RG_STEPS_MAX = 1 << 20, /* control steps of a trial, or of a behaviour: at 40 ms, 11 h */
    RG_MANY = 1 << 26,      /* most trials, robots or segments of a call: indices hold */
    RG_TABLE_MAX = 1 << 24, /* most floats of a table: 64 MB */
    RG_DRAWS = 100000,      /* places drawn for an item of food before it is given up */
};

/* How trials are computed: the best way there is, one by one, or side by side in SIMD lanes of an
 * instruction set. */
enum { RG_BEST = 0, RG_ONE_BY_ONE = 1, RG_AVX2 = 2, RG_AVX512 = 3 };

/* How a call ended. What is not OK says why in an rg_refusal. */
enum {
    RG_OK = 0,
    RG_NOT_FINITE = 1,   /* numbers in range led out of the finite ones */
    RG_BAD_ARGUMENT = 2, /* something given is not finite, out of range or missing */
    RG_NO_ROOM = 3,      /* no place for food outside the nest was found in RG_DRAWS draws */
};

/* What could not be used, or where a call ended. */
typedef struct {
    const char *field; /* as the Python binding calls it */
    int64_t index;     /* of an element, trial, robot, segment or row; -1: there is but one */
    int32_t step;      /* of a trial that ended */
    double got;        /* what was there */
    double low, high;  /* the least and the most that would do */
} rg_refusal;

/* Channels, quantities and forms of laws (embedded_sim/laws.py says what they mean). */
enum { RG_LEFT, RG_RIGHT, RG_BOTH, RG_SPEED, RG_TURNING, RG_TURN, RG_BEND, RG_ASIDE };
enum {
    RG_OF_WHEEL_SPEED,
    RG_OF_SPEED,
    RG_OF_TURN,
    RG_OF_HEADING,
    RG_OF_RADIUS,
    RG_OF_PLACE,
    RG_OF_WALL,
    RG_OF_GAP,
    RG_OF_TIME
};
enum {
    RG_POWER,
    RG_SIGN,
    RG_COSINE,
    RG_SLOPE,
    RG_HALF,
    RG_DISC,
    RG_BELOW,
    RG_FADE,
    RG_CURVE,
    RG_ALWAYS,
    RG_OVER
};

/* A dimensionless function of one quantity. */
typedef struct {
    int32_t of, form;
    int32_t numbers;   /* that count, of: */
    double number[20]; /* a curve has up to 18 nodes */
} rg_atom;

/* A term of a channel: an amplitude times one or two atoms. */
typedef struct {
    int32_t channel, atoms;
    double amplitude;
    rg_atom atom[2];
} rg_law;

/* How the two wheels answer a command, and where the wheels are. Null values in brackets make the
 * minimal model of the paper (III-E); any other value is a named cause of the reality gap. */
typedef struct {
    double wheel_radius[2]; /* m; a negative one turns backwards */
    double axle;            /* m, distance between the wheels' ground contacts */
    double latency;         /* s, command to motor [0] */
    double time_constant;   /* s, first-order answer of the motors [0] */
    double acceleration[2]; /* rad/s^2, most a wheel changes speed by [inf] */
    double speed_limit[2];  /* rad/s, most a wheel turns [inf] */
    double dead_zone[2];    /* rad/s, commands below this do not turn a wheel [0] */
    double droop_rate;      /* 1/s, relative loss of speed with time [0] */
    double start_delay;     /* s, a wheel stands before it starts or turns the other way [0] */
    double turn_first;      /* rad/s, beyond which speed gives way and the turn rate stays [inf] */
    int32_t knots[2];       /* of what a wheel does of what it is told, of: [0: as told] */
    double told[2][8], done[2][8]; /* rad/s, rising; rad/s, never falling */
    int32_t laws;                  /* how many there are, of: [0] */
    rg_law law[8];
    double reach; /* m from the arena's middle to where a robot's touches the wall, for laws */
    double body;  /* m, radius of a robot, for laws */
} rg_drive;

/* Captured tables (III-E): what the sensors of a nominal robot read, looked up bilinearly. */
typedef struct {
    /* infrared: counts[sensor][distance][incidence]; the distance axis is range * u^2 and the
     * incidence axis is the cosine of the angle, both u and the cosine uniform in [0, 1] */
    const float *ps_counts;
    int64_t ps_floats; /* that ps_counts has */
    int32_t ps_distances, ps_incidences;
    double ps_range;       /* m; nothing is seen beyond it */
    double ps_noise[8];    /* half width of uniform noise, relative to the reading */
    double ps_noise_floor; /* half width of uniform noise, counts */
    /* light: counts below dark, [distance][bearing]; the distance axis is range * u^2 with u
     * uniform in [0, 1], bearings (sensor axis to lamp) start at -pi and are uniform on the circle,
     * which a row holds three times and one node more, so that no lookup has to wrap; after the
     * last row come RG_AHEAD floats that may be read and are not used */
    const float *ls_counts;
    int64_t ls_floats; /* that ls_counts has */
    int32_t ls_distances, ls_bearings;
    double ls_range;   /* m */
    double ls_dark[8]; /* counts each sensor reads with the lamps off: more if it is covered */
    double ls_noise;   /* half width of uniform noise, counts */
    double counts_max; /* largest count of the converter */
} rg_tables;

/* Everything a simulator believes. */
typedef struct {
    rg_drive drive;
    rg_tables tables;
    double body_radius;                  /* m */
    double arena_radius;                 /* m, circle about the origin */
    double nest_x, nest_y, nest_radius;  /* m */
    double food_radius;                  /* m, a robot's centre this near to an item is on it */
    int32_t food_items;                  /* always present (III-I), at most RG_FOOD_MAX */
    int32_t lamp_on[3];                  /* per scenario */
    double lamp_x[3], lamp_y[3];         /* m, per scenario */
    double lamp_gain;                    /* on every reading below dark [1] */
    double lamp_decay;                   /* 1/s, relative loss of lamp power with time [0] */
    double second_x, second_y;           /* m, another lamp, in every scenario */
    double second_gain;                  /* of it, relative to the captured lamp [0: none] */
    double sensor_angle[8];              /* rad from forward, counter-clockwise, in [-pi, pi] */
    double sensor_cos[8], sensor_sin[8]; /* of sensor_angle */
    double ps_gain[8];                   /* on every infrared reading [1] */
    double ps_offset[8];                 /* counts, ambient infrared [0] */
    double ls_gain[8];                   /* on every light reading below dark [1] */
    double control_step;                 /* s */
} rg_model;

/* What the four behaviours are made of (III-F): constants of the controller, or, with the
 * continuous genome, its genes; the same on the robot and in its simulator. */
typedef struct {
    double cruise_speed;       /* rad/s of the faster wheel while searching or following light */
    double avoid_threshold[8]; /* counts above which a sensor reports an obstacle; inf: not used */
    double avoid_speed;        /* rad/s of each wheel, opposed, while turning away */
    double avoid_duration;     /* s the turn is committed to */
    double avoid_memory;       /* s after a turn in which the next one goes the same way */
    double search_curvature;   /* widest share by which search slows the inner wheel */
    double search_duration[2]; /* s, shortest and longest stretch of one curvature */
    double light_contrast;     /* counts between the brightest and darkest sensor to see a lamp */
    double light_gain;         /* slowing of the inner wheel per rad of bearing error */
    double light_search;       /* share of search's curvature kept while following light */
    double sensor_cos[8], sensor_sin[8];
    double control_step; /* s */
} rg_behaviour;

/* xoshiro128++ (Blackman and Vigna, 2019): one per robot or trial, seeded by the caller. */
typedef struct {
    uint32_t word[4];
} rg_random;

/* One robot's controller between two steps. */
typedef struct {
    rg_random random;
    int32_t food;            /* carries an item (state Food of III-F) */
    int32_t avoid_steps;     /* steps left of the committed turn and its memory */
    int32_t avoid_direction; /* +1 counter-clockwise, -1 clockwise */
    int32_t search_steps;    /* steps left of the present stretch */
    double search_turn;      /* signed curvature of the present stretch, left positive */
} rg_controller;

/* How two wheels are. */
typedef struct {
    double speed[2]; /* rad/s, present */
    double asked[2]; /* s, for how long a wheel has been told to turn this way, signed as the way */
} rg_wheels;

/* The motors between two commands. */
typedef struct {
    rg_wheels wheels;
    double queue[64][2]; /* rad/s, ring of the last commands */
    int32_t head;        /* slot of the newest command */
    double time;         /* s since the battery was full */
} rg_motors;

/* A set of trials, one genome each under one scenario, as one call runs them. */
typedef struct {
    int32_t steps; /* of control_step each */
    int32_t trials;
    int32_t form;                   /* RG_BEST, or how to compute: the bits are the same */
    const double *genomes;          /* (trials, 2): G0, G1 */
    const int32_t *scenarios;       /* (trials,) 0, 1, 2 */
    const uint32_t *seeds;          /* (trials, 4) */
    const rg_behaviour *behaviours; /* (trials,), or null: every trial has that of the call */
    double *fitness;                /* (trials,) s, eq. 1 */
    int32_t *deposits;              /* (trials,) */
} rg_trials;

/* third of [0, 0.99] a gene lies in: 0, 1, 2 (Figs. 4 and 5) */
int32_t rg_third(double gene);

/* Every call below looks at all that it is given, and ends with RG_BAD_ARGUMENT before it computes
 * anything, or where it meets a row that it cannot use. How long arrays are is what the caller
 * says: the binding makes sure of it. `why` is filled where a call does not end well. */

int32_t rg_check_drive(const rg_drive *d, rg_refusal *why);
int32_t rg_check_model(const rg_model *m, rg_refusal *why);
int32_t rg_check_behaviour(const rg_behaviour *b, rg_refusal *why);

/* The controllers of a swarm, one step: readings and virtual sensor in, wheel speeds (rad/s) out.
 * Arrays are (robots, ...), behaviours too; inactive robots are commanded to stop. picked and
 * dropped are set to 1 where a robot's Food state changed. */
int32_t rg_control_swarm(const rg_behaviour *behaviours, int32_t robots, const uint8_t *active,
                         const double *genomes, rg_controller *controllers, const double *ps,
                         const double *ls, const uint8_t *on_food, const uint8_t *on_nest,
                         double *commands, uint8_t *picked, uint8_t *dropped, rg_refusal *why);

/* Start one controller from four seed words; Food is false. */
void rg_controller_start(rg_controller *c, const uint32_t seed[4]);

/* Has this processor, and this build, the form? */
int32_t rg_has_form(int32_t form);

/* Forage every trial of a set. RG_NOT_FINITE, RG_NO_ROOM: why holds the trial, and its step. */
int32_t rg_evaluate(const rg_model *m, const rg_behaviour *b, rg_trials *set, rg_refusal *why);

/* Drive logged commands through the model, one chain of motors per run and robot.
 * Segment k holds rows start[k] .. start[k+1]-1; commands (rows, 2) hold from their row's time to
 * the next row's. poses (rows, 3): x, y, yaw at each row's time, row start[k] being initial[k].
 * rolling (segments, 2), which may be null (at rest), is how fast (rad/s) the wheels turn at first
 * and until a command has arrived.
 * speeds (rows, 2), if not null, are the wheel speeds at each row's time. seen (rows, 4), which
 * may be null, is where laws find the robot from a row on: x, y, yaw, distance to the next robot's
 * middle (m); without it they find it where the replay has it, and alone. */
int32_t rg_replay(const rg_drive *drive, int64_t rows, int32_t segments, const int64_t *start,
                  const double *t, const double *commands, const double *initial,
                  const double *rolling, double *poses, double *speeds, const double *seen,
                  rg_refusal *why);

/* What the sensors read at given poses (rows, 3), without noise; scenario per row, and t (rows,)
 * the time since the log began (s), which may be null. ps, ls: (rows, 8), either may be null. */
int32_t rg_readings(const rg_model *m, int64_t rows, const double *poses, const int32_t *scenarios,
                    const double *t, double *ps, double *ls, rg_refusal *why);

/* binding end */

#endif

/* The geometry of reality's senses under the sanitizers: crowds drawn at random, every function,
 * arrays of just the size that the header promises. What comes back is finite and within range. */
#include "optics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SENSORS = 8, FACETS = 120, ITEMS = 7, WORLDS = 400 };

static uint64_t state = 0x9e3779b97f4a7c15u;

/* Uniform in [low, high), by a linear congruential generator. */
static double draw(double low, double high) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(state >> 11) / 9007199254740992.0;
}

static void *filled(size_t count, double low, double high) {
    double *array = malloc(count * sizeof *array);
    for (size_t i = 0; i < count; i++)
        array[i] = draw(low, high);
    return array;
}

static void check(int32_t count, const double *values, double low, double high, const char *what) {
    for (int32_t i = 0; i < count; i++) {
        if (values[i] >= low && values[i] <= high) /* not so for NaN */
            continue;
        fprintf(stderr, "%s: %g is not from %g to %g\n", what, values[i], low, high);
        exit(1);
    }
}

static void infrared(const rgo_optics *o, int32_t robots, const double *poses, const double *angles,
                     const double *outward) {
    const size_t all = (size_t)SENSORS * (size_t)robots;
    double *from = filled(3 * all, 0, 1), *to = filled(3 * all, 0, 1);
    double *amplitude = filled(all, 0, 1), *outliers = filled(all, 0, 1);
    double *offset = filled(all, -5, 5), *noise = filled(all, 0, 2);
    double *gauss = filled(2 * all, -3, 3), *uniform = filled(2 * all, 0, 1);
    double *counts = malloc(all * sizeof *counts);
    int32_t *owner = malloc(all * sizeof *owner);
    const int32_t rays = rgo_rays(o, robots, poses, angles, from, to, owner);
    const size_t cast = (size_t)rays;
    double *fraction = malloc(cast * sizeof *fraction),
           *normals = malloc(2 * cast * sizeof *normals);
    double *reflectance = filled(cast, 0, 1);
    uint8_t *on_robot = malloc(cast);
    rgo_cast(rays, from, to, robots, poses, o->body_radius, FACETS, outward, o->arena_radius,
             fraction, normals, on_robot);
    check(rays, fraction, 0.0, 1.0, "fraction");
    check(2 * rays, normals, -1.0 - 1e-9, 1.0 + 1e-9, "normal");
    rgo_infrared(o, robots, poses, angles, rays, owner, fraction, normals, reflectance, amplitude,
                 outliers, offset, noise, gauss, uniform, counts);
    check((int32_t)all, counts, 0.0, o->counts_max, "infrared");
    void *each[] = {from,    to,    amplitude, outliers, offset,  noise,    gauss,
                    uniform, owner, counts,    fraction, normals, on_robot, reflectance};
    for (size_t i = 0; i < sizeof each / sizeof *each; i++)
        free(each[i]);
}

static void light(const rgo_optics *o, int32_t robots, const double *poses, const double *angles) {
    const size_t all = (size_t)SENSORS * (size_t)robots;
    const rgo_lamp lamps[2] = {{draw(-1, 1), draw(-1, 1), 0.1, 23.7, 2.0},
                               {draw(-1, 1), draw(-1, 1), draw(0, 0.2), 5.0, draw(1, 3)}};
    double *ambient = filled(all, 0, 90), *gain = filled(all, 0, 2);
    double *response = filled(all, 0.5, 1.5), *gauss = filled(all, -3, 3);
    double *counts = malloc(all * sizeof *counts);
    rgo_light(o, robots, poses, angles, 2, lamps, ambient, gain, response, gauss, counts);
    check((int32_t)all, counts, 0.0, o->counts_max, "light");
    free(ambient), free(gain), free(response), free(gauss), free(counts);
}

static void rest(const rgo_optics *o, int32_t robots, double *poses) {
    const size_t n = (size_t)robots;
    double *bodies = filled(7 * n, -1, 1), *speeds = filled(6 * n, -1, 1);
    double *food = filled(2 * ITEMS, -0.6, 0.6), *nest = filled(3 * n, 0, 0.5);
    const double centre[3] = {0.008, 0.0, 0.01};
    uint8_t *active = malloc(n), *heard = malloc(n * n), *flags = malloc(2 * n);
    int32_t *item = malloc(n * sizeof *item);
    memset(active, 1, n);
    rgo_radio(o, robots, poses, active, 0.2, heard);
    rgo_virtual_sensor(robots, poses, active, ITEMS, food, 0.05, nest, flags, flags + n, item);
    rgo_poses(robots, bodies, speeds, 0.005, centre, poses);
    rgo_poses(robots, bodies, NULL, 0.0, centre, poses);
    check(3 * robots, poses, -3.2, 3.2, "pose");
    free(bodies), free(speeds), free(food), free(nest);
    free(active), free(heard), free(flags), free(item);
}

int main(void) {
    double outward[2 * FACETS];
    for (int f = 0; f < FACETS; f++) {
        outward[2 * f] = cos(2.0 * acos(-1.0) * f / FACETS);
        outward[2 * f + 1] = sin(2.0 * acos(-1.0) * f / FACETS);
    }
    for (int world = 0; world < WORLDS; world++) {
        const rgo_optics o = {0.035, 0.075, 0.033,  draw(0.1, 3.0), 0.15, 0.009,
                              0.14,  2.0,   4095.0, 4095.0,         5.0};
        const int32_t robots = world % 81; /* none as well; they may overlap and be outside */
        double *poses = filled(3 * (size_t)robots, -1.1 * o.arena_radius, 1.1 * o.arena_radius);
        double *angles = filled((size_t)SENSORS * (size_t)robots, -3.2, 3.2);
        infrared(&o, robots, poses, angles, outward);
        light(&o, robots, poses, angles);
        rest(&o, robots, poses);
        free(poses), free(angles);
    }
    printf("optics: %d worlds\n", WORLDS);
    return 0;
}

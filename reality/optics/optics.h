/* The geometry of reality's senses: rays worth casting, light with shadows, radio line of sight,
 * the tracker's virtual sensor. Poses are (robots, 3): x, y, yaw of the axle's middle (m, m, rad).
 * The part between the marks is read by the Python binding. */
#ifndef RG_OPTICS_H
#define RG_OPTICS_H

#include <stdint.h>

/* binding begin */

/* What a robot's ring of sensors and its body look like to the rays. */
typedef struct {
    double body_radius, body_top;    /* m */
    double sensor_height;            /* m */
    double arena_radius;             /* m */
    double ir_range;                 /* m */
    double ir_offset;                /* m, d0 of A / (d + d0)^2 */
    double ir_noise, ir_noise_floor; /* relative s.d.; counts s.d. */
    double counts_max;
    double light_dark, light_noise; /* counts; counts s.d. */
} rgo_optics;

/* A lamp: irradiance in counts = power * cos / distance^exponent. */
typedef struct {
    double x, y, height;    /* m */
    double power, exponent; /* counts m^exponent; 1 */
} rgo_lamp;

/* Yaw and the middle of the axle from centres of mass (robots, 7: position, quaternion), as they
 * were `back` seconds ago by their velocities (robots, 6: linear, angular); NULL: as they are. */
void rgo_poses(int32_t robots, const double *bodies, const double *velocities, double back,
               const double *centre_of_mass, double *poses);

/* Rays (count, 3) of the sensors that something can be in front of; owner[r] = robot * 8 + sensor.
 * Others cannot hit anything within range and read zero. Returns the count. */
int32_t rgo_rays(const rgo_optics *o, int32_t robots, const double *poses, const double *angles,
                 double *from, double *to, int32_t *owner);

/* What level rays (count, 3) meet, exactly: upright cylinders about poses (robots, 3), and a wall
 * of straight facets, each through radius * its outward normal (facets, 2). Fills the fraction of
 * each ray (count,), 1 where nothing is hit, the normal there (count, 2), and whether a robot is
 * hit (count,). A ray that starts inside a body, or behind the wall, and goes on into it meets it
 * at once. */
void rgo_cast(int32_t count, const double *from, const double *to, int32_t robots,
              const double *poses, double body_radius, int32_t facets, const double *outward,
              double wall_radius, double *fraction, double *normals, uint8_t *on_robot);

/* Counts (robots, 8) from ray hits: fraction of the range (1: nothing), the hit's normal (x, y) and
 * its reflectance, 1 for the nominal surface. gauss, uniform: (2, robots, 8) random numbers.
 * amplitude, outliers, offset (counts), noise (on both noises): (robots, 8). */
void rgo_infrared(const rgo_optics *o, int32_t robots, const double *poses, const double *angles,
                  int32_t rays, const int32_t *owner, const double *fraction, const double *normals,
                  const double *reflectance, const double *amplitude, const double *outliers,
                  const double *offset, const double *noise, const double *gauss,
                  const double *uniform, double *counts);

/* Light counts (robots, 8). Robots shade one another. ambient, gain: (robots, 8). response
 * (robots, 8): exponent of the sensor's answer, as a share of full scale; 1 is linear. */
void rgo_light(const rgo_optics *o, int32_t robots, const double *poses, const double *angles,
               int32_t lamps, const rgo_lamp *lamp, const double *ambient, const double *gain,
               const double *response, const double *gauss, double *counts);

/* heard (robots, robots): receiver, sender; within range, and no third robot in between. */
void rgo_radio(const rgo_optics *o, int32_t robots, const double *poses, const uint8_t *active,
               double range, uint8_t *heard);

/* Virtual sensor; nest (robots, 3): x, y, radius (m). An item is offered to one robot at a time:
 * the first that carries none. item[i]: the item robot i is on, or -1. */
void rgo_virtual_sensor(int32_t robots, const double *poses, const uint8_t *carrying, int32_t items,
                        const double *food, double food_radius, const double *nest,
                        uint8_t *on_food, uint8_t *on_nest, int32_t *item);

/* binding end */

#endif

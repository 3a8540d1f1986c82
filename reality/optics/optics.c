#include "optics.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846 /* C11 itself has none */
enum { SENSORS = 8, NEAR = 64 };

void rgo_poses(int32_t robots, const double *bodies, const double *velocities, double back,
               const double *centre_of_mass, double *poses) {
    for (int32_t i = 0; i < robots; i++) {
        const double *b = bodies + 7 * i;
        const double qx = b[3], qy = b[4], qz = b[5], qw = b[6];
        double yaw = atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz));
        if (velocities)
            yaw = remainder(yaw - back * velocities[6 * i + 5], 2.0 * PI);
        const double c = cos(yaw), s = sin(yaw);
        poses[3 * i] = b[0] - c * centre_of_mass[0] + s * centre_of_mass[1];
        poses[3 * i + 1] = b[1] - s * centre_of_mass[0] - c * centre_of_mass[1];
        poses[3 * i + 2] = yaw;
        if (velocities) {
            poses[3 * i] -= back * velocities[6 * i];
            poses[3 * i + 1] -= back * velocities[6 * i + 1];
        }
    }
}

/* Does the segment from p, `length` along unit u, pass within `reach` of the point q? */
static int passes(double px, double py, double ux, double uy, double length, double qx, double qy,
                  double reach) {
    const double dx = qx - px, dy = qy - py;
    const double along = fmin(fmax(dx * ux + dy * uy, 0.0), length);
    const double ex = dx - along * ux, ey = dy - along * uy;
    return ex * ex + ey * ey <= reach * reach;
}

/* Which robots are within `reach` of robot i? Returns how many; beyond NEAR none are told. */
static int32_t neighbours(int32_t robots, const double *poses, int32_t i, double reach,
                          int32_t *near) {
    int32_t found = 0;
    for (int32_t j = 0; j < robots; j++) {
        const double dx = poses[3 * j] - poses[3 * i], dy = poses[3 * j + 1] - poses[3 * i + 1];
        if (j == i || dx * dx + dy * dy > reach * reach)
            continue;
        if (found < NEAR)
            near[found] = j;
        found++;
    }
    return found;
}

int32_t rgo_rays(const rgo_optics *o, int32_t robots, const double *poses, const double *angles,
                 double *from, double *to, int32_t *owner) {
    const double start = o->body_radius + 1e-4; /* outside one's own body */
    const double slack = 1e-3;                  /* m; the engine's shapes against these circles */
    const double reach = start + o->ir_range + o->body_radius + 2.0 * slack;
    int32_t count = 0;
    for (int32_t i = 0; i < robots; i++) {
        const double x = poses[3 * i], y = poses[3 * i + 1], yaw = poses[3 * i + 2];
        int32_t near[NEAR];
        const int32_t found = neighbours(robots, poses, i, reach, near);
        const int crowded = found > NEAR; /* they overlap: ask all */
        for (int k = 0; k < SENSORS; k++) {
            const double ux = cos(yaw + angles[SENSORS * i + k]);
            const double uy = sin(yaw + angles[SENSORS * i + k]);
            const double px = x + start * ux, py = y + start * uy;
            const double ex = px + o->ir_range * ux, ey = py + o->ir_range * uy;
            const double clear = o->arena_radius - slack;
            int worth = ex * ex + ey * ey > clear * clear;
            for (int32_t n = 0; n < (crowded ? robots : found) && !worth; n++) {
                const int32_t j = crowded ? n : near[n];
                worth = j != i && passes(px, py, ux, uy, o->ir_range, poses[3 * j],
                                         poses[3 * j + 1], o->body_radius + slack);
            }
            if (!worth)
                continue;
            from[3 * count] = px, from[3 * count + 1] = py;
            to[3 * count] = ex, to[3 * count + 1] = ey;
            from[3 * count + 2] = to[3 * count + 2] = o->sensor_height;
            owner[count++] = SENSORS * i + k;
        }
    }
    return count;
}

void rgo_cast(int32_t count, const double *from, const double *to, int32_t robots,
              const double *poses, double body_radius, int32_t facets, const double *outward,
              double wall_radius, double *fraction, double *normals, uint8_t *on_robot) {
    const double clear = wall_radius * (1.0 - 1e-9); /* beyond any rounding */
    for (int32_t r = 0; r < count; r++) {
        const double px = from[3 * r], py = from[3 * r + 1];
        const double dx = to[3 * r] - px, dy = to[3 * r + 1] - py, length = sqrt(dx * dx + dy * dy);
        const double ux = dx / length, uy = dy / length;
        double nearest = length, nx = 0.0, ny = 0.0;
        uint8_t robot = 0;
        /* a ray between two points within the circle that the facets touch meets none */
        const double ex = px + dx, ey = py + dy;
        const int within = fmax(px * px + py * py, ex * ex + ey * ey) < clear * clear;
        for (int32_t f = 0; f < facets && !within; f++) {
            const double ox = outward[2 * f], oy = outward[2 * f + 1];
            const double towards = ux * ox + uy * oy;
            if (towards <= 0.0)
                continue;
            const double away = fmax((wall_radius - px * ox - py * oy) / towards, 0.0);
            if (away < nearest)
                nearest = away, nx = -ox, ny = -oy;
        }
        for (int32_t j = 0; j < robots; j++) {
            const double qx = poses[3 * j] - px, qy = poses[3 * j + 1] - py;
            const double along = qx * ux + qy * uy, aside = qx * uy - qy * ux;
            const double half = body_radius * body_radius - aside * aside;
            if (along <= 0.0 || half <= 0.0)
                continue;
            const double away = fmax(along - sqrt(half), 0.0);
            if (away < nearest) {
                nearest = away, robot = 1;
                nx = (away * ux - qx) / body_radius, ny = (away * uy - qy) / body_radius;
            }
        }
        fraction[r] = nearest / length;
        normals[2 * r] = nx, normals[2 * r + 1] = ny;
        on_robot[r] = robot;
    }
}

/* A gross outlier of the infrared: off by more than half, a third of them zero. */
static double outlier(double uniform) {
    return uniform < 1.0 / 3.0   ? 0.0
           : uniform < 2.0 / 3.0 ? 0.5 * (3.0 * uniform - 1.0)
                                 : 3.0 * uniform - 0.5;
}

void rgo_infrared(const rgo_optics *o, int32_t robots, const double *poses, const double *angles,
                  int32_t rays, const int32_t *owner, const double *fraction, const double *normals,
                  const double *reflectance, const double *amplitude, const double *outliers,
                  const double *offset, const double *noise, const double *gauss,
                  const double *uniform, double *counts) {
    const int32_t all = SENSORS * robots;
    memset(counts, 0, (size_t)all * sizeof *counts);
    for (int32_t r = 0; r < rays; r++) {
        if (fraction[r] >= 1.0)
            continue;
        const int32_t at = owner[r];
        const double angle = poses[3 * (at / SENSORS) + 2] + angles[at];
        const double cosine = -(cos(angle) * normals[2 * r] + sin(angle) * normals[2 * r + 1]);
        const double d = fraction[r] * o->ir_range + o->ir_offset;
        counts[at] = amplitude[at] * reflectance[r] * fmax(cosine, 0.0) / (d * d);
    }
    for (int32_t at = 0; at < all; at++) {
        double value = counts[at] * (1.0 + o->ir_noise * noise[at] * gauss[at]);
        if (uniform[at] < outliers[at])
            value = counts[at] * outlier(uniform[all + at]);
        value += o->ir_noise_floor * noise[at] * gauss[all + at] + offset[at];
        counts[at] = rint(fmin(fmax(value, 0.0), o->counts_max));
    }
}

/* Is the straight way from (px, py), `length` along unit u, to the lamp cut by a body at q? */
static int shaded(const rgo_optics *o, double px, double py, double ux, double uy, double length,
                  double lamp_height, double qx, double qy) {
    const double along = (qx - px) * ux + (qy - py) * uy;
    const double aside = (qx - px) * uy - (qy - py) * ux;
    const double half = o->body_radius * o->body_radius - aside * aside;
    if (half <= 0.0)
        return 0;
    const double enter = along - sqrt(half), leave = along + sqrt(half);
    if (leave <= 0.0 || enter >= length)
        return 0;
    const double climb = (lamp_height - o->sensor_height) / length;
    const double lowest = climb > 0.0 ? fmax(enter, 0.0) : fmin(leave, length);
    return o->sensor_height + climb * lowest < o->body_top;
}

void rgo_light(const rgo_optics *o, int32_t robots, const double *poses, const double *angles,
               int32_t lamps, const rgo_lamp *lamp, const double *ambient, const double *gain,
               const double *response, const double *gauss, double *counts) {
    for (int32_t i = 0; i < robots; i++) {
        const double x = poses[3 * i], y = poses[3 * i + 1], yaw = poses[3 * i + 2];
        for (int k = 0; k < SENSORS; k++) {
            const int32_t at = SENSORS * i + k;
            const double ux = cos(yaw + angles[at]), uy = sin(yaw + angles[at]);
            const double px = x + o->body_radius * ux, py = y + o->body_radius * uy;
            double light = ambient[at];
            for (int32_t l = 0; l < lamps; l++) {
                const double vx = lamp[l].x - px, vy = lamp[l].y - py;
                const double vz = lamp[l].height - o->sensor_height;
                const double facing = vx * ux + vy * uy;
                if (facing <= 0.0)
                    continue;
                const double length = sqrt(vx * vx + vy * vy), wx = vx / length, wy = vy / length;
                int dark = 0;
                for (int32_t j = 0; j < robots && !dark; j++)
                    dark = j != i && shaded(o, px, py, wx, wy, length, lamp[l].height, poses[3 * j],
                                            poses[3 * j + 1]);
                if (dark)
                    continue;
                const double distance = sqrt(vx * vx + vy * vy + vz * vz);
                light += lamp[l].power * facing / distance / pow(distance, lamp[l].exponent);
            }
            double signal = gain[at] * light;
            if (response[at] != 1.0)
                signal = o->light_dark * pow(signal / o->light_dark, response[at]);
            const double value = o->light_dark - signal + o->light_noise * gauss[at];
            counts[at] = rint(fmin(fmax(value, 0.0), o->counts_max));
        }
    }
}

void rgo_radio(const rgo_optics *o, int32_t robots, const double *poses, const uint8_t *active,
               double range, uint8_t *heard) {
    memset(heard, 0, (size_t)robots * (size_t)robots);
    for (int32_t i = 0; i < robots; i++) {
        for (int32_t j = i + 1; j < robots; j++) {
            const double dx = poses[3 * j] - poses[3 * i];
            const double dy = poses[3 * j + 1] - poses[3 * i + 1];
            const double length = sqrt(dx * dx + dy * dy);
            if (!active[i] || !active[j] || length > range)
                continue;
            int blocked = 0;
            for (int32_t k = 0; k < robots && !blocked; k++)
                blocked = k != i && k != j &&
                          passes(poses[3 * i], poses[3 * i + 1], dx / length, dy / length, length,
                                 poses[3 * k], poses[3 * k + 1], o->body_radius);
            heard[i * robots + j] = heard[j * robots + i] = (uint8_t)!blocked;
        }
    }
}

void rgo_virtual_sensor(int32_t robots, const double *poses, const uint8_t *carrying, int32_t items,
                        const double *food, double food_radius, const double *nest,
                        uint8_t *on_food, uint8_t *on_nest, int32_t *item) {
    for (int32_t i = 0; i < robots; i++) {
        const double nx = poses[3 * i] - nest[3 * i], ny = poses[3 * i + 1] - nest[3 * i + 1];
        on_nest[i] = (uint8_t)(nx * nx + ny * ny < nest[3 * i + 2] * nest[3 * i + 2]);
        item[i] = -1;
        for (int32_t f = 0; f < items && item[i] < 0; f++) {
            const double dx = poses[3 * i] - food[2 * f], dy = poses[3 * i + 1] - food[2 * f + 1];
            if (dx * dx + dy * dy >= food_radius * food_radius)
                continue;
            int taken = 0;
            for (int32_t j = 0; j < i; j++)
                taken |= item[j] == f && !carrying[j];
            if (!taken)
                item[i] = f;
        }
        on_food[i] = (uint8_t)(item[i] >= 0);
    }
}

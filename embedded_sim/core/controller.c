/* The controller as the robot runs it: readings in, wheel speeds out. */
#include "behaviour.h"
#include "check.h"
#include "random.h"
#include "realitygap_core.h"
#include "small.h"

int32_t rg_third(double gene) { return gene < 0.33 ? 0 : gene < 0.66 ? 1 : 2; }

void rg_controller_start(rg_controller *c, const uint32_t seed[4]) {
    rg_seed(&c->random, seed);
    c->food = 0;
    c->avoid_steps = 0;
    c->avoid_direction = 1;
    c->search_steps = 0;
    c->search_turn = 0.0;
}

/* One controller step. */
static void rg_control(const rg_behaviour *b, const double genome[2], rg_controller *c,
                       const double *ps, const double *ls, int32_t on_food, int32_t on_nest,
                       double *command) {
    const rg_pace pace = rg_pace_of(b);
    rg_handle_food(c, on_food, on_nest);
    const double turn = rg_search(b, c);
    double right = 0.0, left = 0.0; /* strongest reading on each side, in thresholds */
    for (int k = 0; k < 4 && c->avoid_steps <= pace.memory; k++) {
        right = rg_max(right, ps[k] / b->avoid_threshold[k]);
        left = rg_max(left, ps[7 - k] / b->avoid_threshold[7 - k]);
    }
    if (rg_turns_away(&pace, c, rg_obstacle(right, left))) {
        rg_spin(b, c, command);
        return;
    }
    const int32_t taxis = rg_third(c->food ? genome[0] : genome[1]) - 1; /* -1, 0, +1 */
    rg_steer(b, taxis == 0 ? turn : rg_follow(b, taxis, ls, turn), command);
}

/* Is all that robot i senses and remembers usable? */
static int rg_check_robot(rg_refusal *why, int32_t i, const double *genome, const rg_controller *c,
                          const double *ps, const double *ls) {
    int wrong = 0;
    for (int k = 0; k < RG_SENSORS; k++)
        wrong |= !rg_finite(ps[k]) | !rg_finite(ls[k]);
    for (int k = 0; wrong && k < RG_SENSORS; k++)
        if (!rg_within(why, "ps", i, ps[k], RG_DATA) || !rg_within(why, "ls", i, ls[k], RG_DATA))
            return 0;
    return rg_within(why, "genomes", i, genome[0], RG_ANY) &&
           rg_within(why, "genomes", i, genome[1], RG_ANY) &&
           rg_within(why, "controllers.avoid_steps", i, c->avoid_steps, 0.0, 2.0 * RG_STEPS_MAX) &&
           rg_within(why, "controllers.avoid_direction", i, c->avoid_direction, -1.0, 1.0) &&
           rg_within(why, "controllers.search_steps", i, c->search_steps, 0.0, RG_STEPS_MAX) &&
           rg_within(why, "controllers.search_turn", i, c->search_turn, RG_ANY);
}

static int rg_check_swarm(rg_refusal *why, const rg_behaviour *behaviours, int32_t robots,
                          const rg_controller *controllers, const void *const arrays[9]) {
    static const char *const names[9] = {"active",  "genomes",  "ps",     "ls",     "on_food",
                                         "on_nest", "commands", "picked", "dropped"};
    if (!(rg_within(why, "robots", -1, robots, 0.0, RG_MANY) &&
          rg_there(why, "behaviours", behaviours, robots) &&
          rg_there(why, "controllers", controllers, robots)))
        return 0;
    for (int k = 0; k < 9; k++)
        if (!rg_there(why, names[k], arrays[k], robots))
            return 0;
    return 1;
}

int32_t rg_control_swarm(const rg_behaviour *behaviours, int32_t robots, const uint8_t *active,
                         const double *genomes, rg_controller *controllers, const double *ps,
                         const double *ls, const uint8_t *on_food, const uint8_t *on_nest,
                         double *commands, uint8_t *picked, uint8_t *dropped, rg_refusal *why) {
    const void *const arrays[9] = {active,  genomes,  ps,     ls,     on_food,
                                   on_nest, commands, picked, dropped};
    if (!rg_check_swarm(why, behaviours, robots, controllers, arrays))
        return RG_BAD_ARGUMENT;
    for (int32_t i = 0; i < robots; i++)
        if (active[i] && (rg_check_behaviour(&behaviours[i], why) != RG_OK ||
                          !rg_check_robot(why, i, genomes + 2 * i, &controllers[i],
                                          ps + RG_SENSORS * i, ls + RG_SENSORS * i)))
            return RG_BAD_ARGUMENT;
    for (int32_t i = 0; i < robots; i++) {
        picked[i] = dropped[i] = 0;
        commands[2 * i] = commands[2 * i + 1] = 0.0;
        if (!active[i])
            continue;
        rg_controller *c = &controllers[i];
        const int32_t before = c->food;
        rg_control(&behaviours[i], genomes + 2 * i, c, ps + RG_SENSORS * i, ls + RG_SENSORS * i,
                   on_food[i], on_nest[i], commands + 2 * i);
        picked[i] = (uint8_t)(!before && c->food);
        dropped[i] = (uint8_t)(before && !c->food);
    }
    return RG_OK;
}

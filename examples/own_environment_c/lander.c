/* A lander that falls onto a planet and is slowed down by its engine, in gusts of wind.
 *
 * cc -O2 -shared -fPIC -ffp-contract=off -I"$(python -c 'import qtab; print(qtab.get_include())')" lander.c -o liblander.so
 */
#include <stddef.h>

#include "qtab_env.h"

/* The state of an episode. */
typedef struct {
    double height;   /* m */
    double velocity; /* m/s, upwards */
} lander;

/* The parameters, which no function changes. */
typedef struct {
    double gravity; /* m/s^2 */
    double thrust;  /* m/s^2 */
    double gust;    /* m/s, the largest change of the velocity by the wind in a step */
    double seconds; /* the length of a step */
} planet;

static double uniform(const qtab_bitgen *rng, double low, double high) {
    return low + (high - low) * rng->next_double(rng->state);
}

static int32_t observe(const void *parameters, const void *state, void *observation, uint8_t *action_mask) {
    const lander *now = state;
    float *numbers = observation;
    (void)parameters;
    (void)action_mask;
    numbers[0] = (float)now->height;
    numbers[1] = (float)now->velocity;
    return QTAB_CONTINUES;
}

static int32_t reset(const void *parameters, const qtab_bitgen *rng, void *state, void *observation,
                     uint8_t *action_mask) {
    lander *first = state;
    first->height = uniform(rng, 40.0, 60.0);
    first->velocity = uniform(rng, -5.0, 0.0);
    return observe(parameters, state, observation, action_mask);
}

static int32_t step(const void *parameters, const qtab_bitgen *rng, const void *state, int64_t action, void *next_state,
                    void *observation, double *reward, uint8_t *action_mask) {
    const planet *on = parameters;
    const lander *now = state;
    lander *next = next_state;
    double acceleration = action == 1 ? on->thrust - on->gravity : -on->gravity;
    double velocity = now->velocity + acceleration * on->seconds + uniform(rng, -on->gust, on->gust);
    double height = now->height + velocity * on->seconds;
    int landed = height <= 0.0;
    next->velocity = velocity < -30.0 ? -30.0 : velocity > 30.0 ? 30.0 : velocity;
    next->height = landed ? 0.0 : height > 100.0 ? 100.0 : height;
    *reward = landed ? -(next->velocity * next->velocity) : action == 1 ? -1.0 : 0.0;
    observe(parameters, next_state, observation, action_mask);
    return landed ? QTAB_TERMINATED : QTAB_CONTINUES;
}

static const planet mars = {3.7, 8.0, 0.3, 0.25};
static const double lowest[] = {0.0, -30.0};
static const double highest[] = {100.0, 30.0};

static const qtab_env environment = {
    .version = QTAB_ENV_VERSION,
    .struct_size = sizeof(qtab_env),
    .state_size = sizeof(lander),
    .observation_type = QTAB_FLOAT32,
    .observation_size = 2,
    .observation_low = lowest,
    .observation_high = highest,
    .num_actions = 2,
    .max_episode_steps = 200,
    .parameters = &mars,
    .reset = reset,
    .step = step,
    .observe = observe,
};

const qtab_env *qtab_env_1(void) {
    return &environment;
}

/* MountainCar-v0 of Gymnasium. */
#include <math.h>
#include <stddef.h>

#include "qtab_env.h"

typedef struct {
    double position;
    double velocity;
} car;

static int32_t observe(const void *parameters, const void *state, void *observation, uint8_t *action_mask) {
    const car *now = state;
    float *numbers = observation;
    (void)parameters;
    (void)action_mask;
    numbers[0] = (float)now->position;
    numbers[1] = (float)now->velocity;
    return QTAB_CONTINUES;
}

static int32_t reset(const void *parameters, const qtab_bitgen *rng, void *state, void *observation,
                     uint8_t *action_mask) {
    car *first = state;
    first->position = -0.6 + (-0.4 - -0.6) * rng->next_double(rng->state);
    first->velocity = 0.0;
    return observe(parameters, state, observation, action_mask);
}

static int32_t step(const void *parameters, const qtab_bitgen *rng, const void *state, int64_t action, void *next_state,
                    void *observation, double *reward, uint8_t *action_mask) {
    const car *now = state;
    car *next = next_state;
    double position = now->position, velocity = now->velocity;
    (void)rng;
    velocity += (double)(action - 1) * 0.001 + cos(3.0 * position) * -0.0025;
    velocity = velocity < -0.07 ? -0.07 : velocity > 0.07 ? 0.07 : velocity;
    position += velocity;
    position = position < -1.2 ? -1.2 : position > 0.6 ? 0.6 : position;
    if (position == -1.2 && velocity < 0.0) {
        velocity = 0.0;
    }
    next->position = position;
    next->velocity = velocity;
    *reward = -1.0;
    observe(parameters, next_state, observation, action_mask);
    return position >= 0.5 && velocity >= 0.0 ? QTAB_TERMINATED : QTAB_CONTINUES;
}

static const double lowest[] = {-1.2f, -0.07f};
static const double highest[] = {0.6f, 0.07f};

static const qtab_env environment = {
    .version = QTAB_ENV_VERSION,
    .struct_size = sizeof(qtab_env),
    .state_size = sizeof(car),
    .observation_type = QTAB_FLOAT32,
    .observation_size = 2,
    .observation_low = lowest,
    .observation_high = highest,
    .num_actions = 3,
    .max_episode_steps = 200,
    .reset = reset,
    .step = step,
    .observe = observe,
};

const qtab_env *qtab_env_1(void) {
    return &environment;
}

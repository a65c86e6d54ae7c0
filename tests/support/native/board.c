/* A walk on a board of 5 x 3 squares with a forbidden action on its edge. The options below make it break a rule. */
#include <math.h>
#include <stddef.h>

#include "qtab_env.h"

#ifndef VERSION
#define VERSION QTAB_ENV_VERSION
#endif
#ifndef STRUCT_SIZE
#define STRUCT_SIZE sizeof(qtab_env)
#endif
#ifndef ACTIONS
#define ACTIONS 3
#endif
#ifndef TYPE
#define TYPE QTAB_INT64
#define NUMBER int64_t
#endif
#ifndef FAILS_AT
#define FAILS_AT 99
#endif

typedef struct {
    int32_t x;     /* -2 to 2 */
    int32_t y;     /* 3 to 5 */
    int32_t steps; /* in the episode */
} board;

static int is_over(const board *now) {
    return now->x == 2 && now->y == 5;
}

static int32_t observe(const void *parameters, const void *state, void *observation, uint8_t *action_mask) {
    const board *now = state;
    NUMBER *numbers = observation;
    (void)parameters;
    numbers[0] = (NUMBER)now->x;
    numbers[1] = (NUMBER)now->y;
    action_mask[0] = now->x > -2 && !is_over(now);
    action_mask[1] = now->x < 2 && !is_over(now);
    action_mask[2] = !is_over(now);
#ifdef NO_ACTION
    if (now->steps == NO_ACTION) {
        action_mask[0] = action_mask[1] = action_mask[2] = 0;
    }
#endif
    return QTAB_CONTINUES;
}

static int32_t reset(const void *parameters, const qtab_bitgen *rng, void *state, void *observation,
                     uint8_t *action_mask) {
    board *first = state;
    first->x = -2 + (int32_t)(rng->next_uint32(rng->state) % 3);
    first->y = 3;
    first->steps = 0;
#ifdef RESET_FAILS
    return QTAB_FAILED;
#endif
    return observe(parameters, state, observation, action_mask);
}

static int32_t step(const void *parameters, const qtab_bitgen *rng, const void *state, int64_t action, void *next_state,
                    void *observation, double *reward, uint8_t *action_mask) {
    const board *now = state;
    board *next = next_state;
    double chance = rng->next_double(rng->state);
    next->x = now->x + (action == 0 ? -1 : action == 1 ? 1 : 0);
    next->y = chance < 0.3 ? (now->y == 5 ? 3 : now->y + 1) : now->y;
    next->steps = now->steps + 1;
    *reward = is_over(next) ? 10.0 : -1.0 - 0.25 * chance;
    if (next->x < -2 || next->x > 2 || next->steps == FAILS_AT) {
        return QTAB_FAILED;
    }
    observe(parameters, next_state, observation, action_mask);
#ifdef CRASHES
    *(volatile int *)NULL = 0;
#endif
#ifdef NAN_REWARD
    *reward = NAN;
#endif
#ifdef BAD_OBSERVATION
    ((NUMBER *)observation)[1] = BAD_OBSERVATION;
#endif
#ifdef BEYOND
    ((NUMBER *)observation)[2] = 0;
#endif
#ifdef CODE
    return CODE;
#endif
    if (next->steps == 12 && !is_over(next)) {
        return QTAB_TRUNCATED;
    }
    return is_over(next) ? QTAB_TERMINATED : QTAB_CONTINUES;
}

static const double lowest[] = {-2.0, 3.0};
static const double highest[] = {2.0, 5.0};

static const qtab_env environment = {
    .version = VERSION,
    .struct_size = STRUCT_SIZE,
    .state_size = sizeof(board),
    .observation_type = TYPE,
    .observation_size = 2,
#ifndef UNBOUNDED
    .observation_low = lowest,
    .observation_high = highest,
#endif
    .num_actions = ACTIONS,
    .has_action_mask = 1,
    .reset = reset,
    .step = step,
    .observe = observe,
};

#ifndef NO_SYMBOL
const qtab_env *qtab_env_1(void) {
#ifdef RETURNS_NULL
    return NULL;
#endif
    return &environment;
}
#endif

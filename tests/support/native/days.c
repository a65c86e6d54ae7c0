/* Days that pass: the state is the number of the day, and the last day is terminal. */
#include "qtab_env.h"
#define UNUSED (void)parameters, (void)rng, (void)action
#ifndef TERMINATES_AT
#define TERMINATES_AT 1
#endif
#ifndef STATE_SIZE
#define STATE_SIZE sizeof(int64_t)
#endif
#ifndef LIMIT
#define LIMIT 0
#endif
#ifndef REWARD
#define REWARD 1.0
#endif
static void write(int64_t day, void *observation, uint8_t *mask) {
    *(int64_t *)observation = day;
    mask[0] = mask[1] = day < TERMINATES_AT;
}
static int32_t reset(const void *parameters, const qtab_bitgen *rng, void *state, void *observation, uint8_t *mask) {
    int64_t action = 0;
    UNUSED;
    *(int64_t *)state = 0;
    write(0, observation, mask);
    return QTAB_CONTINUES;
}
static int32_t step(const void *parameters, const qtab_bitgen *rng, const void *state, int64_t action, void *next_state,
                    void *observation, double *reward, uint8_t *mask) {
    int64_t day = *(const int64_t *)state + 1;
    UNUSED;
#ifdef HANGS
    for (volatile int i = 0;; i = 1 - i) {}
#endif
    *(int64_t *)next_state = day;
    *reward = REWARD;
    write(day, observation, mask);
    return day >= TERMINATES_AT ? QTAB_TERMINATED : QTAB_CONTINUES;
}
static int32_t observe(const void *parameters, const void *state, void *observation, uint8_t *mask) {
    (void)parameters;
    write(*(const int64_t *)state, observation, mask);
    return QTAB_CONTINUES;
}
static const double low[] = {0}, high[] = {10};
static const qtab_env env = {
    QTAB_ENV_VERSION, sizeof(qtab_env), STATE_SIZE, QTAB_INT64, 1, low, high, 2, LIMIT, 1, 0, 0,
    reset, step, observe,
};
const qtab_env *qtab_env_1(void);
const qtab_env *qtab_env_1(void) { return &env; }

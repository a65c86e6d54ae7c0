/* qtab_env.h: an environment as a table of C functions, version 1.
 *
 * A library exports one function, `const qtab_env *qtab_env_1(void)`, and `qtab.NativeEnv("libmy_env.so")` trains on it.
 * Make its other functions static: other libraries may have functions of the same names; glibc has one called `step`.
 * The functions keep nothing between calls: the state is memory of the caller, and random numbers come from the
 * generator that the caller passes. Several threads call them at the same time. `observation` and `action_mask` are never
 * NULL; their bytes may be those of an earlier state. A terminal state needs no action mask. A step that returns both
 * QTAB_TERMINATED and QTAB_TRUNCATED counts as terminated.
 */
#ifndef QTAB_ENV_H
#define QTAB_ENV_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define QTAB_ENV_VERSION 1

/* A random generator: the `bitgen_t` of NumPy (numpy/random/bitgen.h). `next_double` returns what `rng.random()` does. */
typedef struct qtab_bitgen {
    void *state;
    uint64_t (*next_uint64)(void *state);
    uint32_t (*next_uint32)(void *state);
    double (*next_double)(void *state);
    uint64_t (*next_raw)(void *state);
} qtab_bitgen;

/* The type of the numbers of an observation. */
enum { QTAB_FLOAT32 = 0, QTAB_FLOAT64 = 1, QTAB_INT64 = 2 };

/* What `reset` and `step` return: a sum of these, or QTAB_FAILED. */
enum { QTAB_CONTINUES = 0, QTAB_TERMINATED = 1, QTAB_TRUNCATED = 2, QTAB_FAILED = -1 };

/* All pointers stay valid, and all numbers unchanged, while the library is loaded. */
typedef struct qtab_env {
    uint32_t version;               /* QTAB_ENV_VERSION */
    uint32_t struct_size;           /* sizeof(qtab_env) */
    uint64_t state_size;            /* the bytes of a state, which the caller aligns to 16 */
    uint32_t observation_type;      /* QTAB_FLOAT32, QTAB_FLOAT64 or QTAB_INT64 */
    uint32_t observation_size;      /* the numbers of an observation */
    const double *observation_low;  /* their lowest values, `observation_size` of them; NULL: unbounded */
    const double *observation_high; /* their highest values, inclusive; NULL: unbounded */
    int64_t num_actions;            /* actions are 0 to num_actions - 1 */
    int64_t max_episode_steps;      /* the time limit; 0: none */
    uint32_t has_action_mask;       /* 1 if the functions write the action mask */
    uint32_t reserved;              /* 0 */
    const void *parameters;         /* passed to the functions; may be NULL */

    /* Writes the first state of an episode, its observation and its action mask. */
    int32_t (*reset)(const void *parameters, const qtab_bitgen *rng, void *state, void *observation,
                     uint8_t *action_mask);

    /* One step: reads `state`, and writes the next state, its observation, the reward and the next action mask. `state`
     * and `next_state` do not overlap. */
    int32_t (*step)(const void *parameters, const qtab_bitgen *rng, const void *state, int64_t action, void *next_state,
                    void *observation, double *reward, uint8_t *action_mask);

    /* Writes the observation and the action mask of a state. */
    int32_t (*observe)(const void *parameters, const void *state, void *observation, uint8_t *action_mask);
} qtab_env;

#ifdef __cplusplus
}
#endif
#endif

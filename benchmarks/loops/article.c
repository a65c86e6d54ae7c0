/* The article's training loop with MountainCar's physics, as one writes it in C. The random numbers are those of NumPy's
   generators, through the interface that NumPy offers to C. */

#include <math.h>
#include <stdint.h>

typedef struct {
    void *state;
    uint64_t (*next_uint64)(void *);
    uint32_t (*next_uint32)(void *);
    double (*next_double)(void *);
    uint64_t (*next_raw)(void *);
} bitgen;

/* rng.integers(0, 3): D. Lemire, "Fast random integer generation in an interval", 2019. */
static int random_action(bitgen *rng)
{
    uint64_t product = (uint64_t)rng->next_uint32(rng->state) * 3;
    if ((uint32_t)product < 3)
        while ((uint32_t)product < (UINT32_MAX - 2) % 3)
            product = (uint64_t)rng->next_uint32(rng->state) * 3;
    return (int)(product >> 32);
}

static int greedy(const double *values)
{
    int best = 0;
    for (int action = 1; action < 3; action++)
        if (values[action] > values[best])
            best = action;
    return best;
}

/* The row of the cell in the table of 19 x 15 cells. */
static double *cell(double *q, double position, double velocity)
{
    int row = (int)rint((double)((float)position - -1.2f) * 10.0);
    int column = (int)rint((double)((float)velocity - -0.07f) * 100.0);
    return q + (row * 15 + column) * 3;
}

/* Trains q, 19 x 15 x 3, and returns the number of steps. */
int64_t q_learning(double *q, bitgen *env, bitgen *agent, int64_t episodes, double learning_rate, double discount,
                   double epsilon, double min_epsilon)
{
    double reduction = (epsilon - min_epsilon) / (double)episodes;
    int64_t steps = 0;
    for (int64_t episode = 0; episode < episodes; episode++) {
        double position = -0.6 + (-0.4 - -0.6) * env->next_double(env->state), velocity = 0.0;
        double *values = cell(q, position, velocity);
        int done = 0;
        for (int step = 0; step < 200 && !done; step++) {
            int explores = agent->next_double(agent->state) >= 1.0 - epsilon;
            int action = explores ? random_action(agent) : greedy(values);
            velocity += (action - 1) * 0.001 + cos(3 * position) * -0.0025;
            velocity = fmin(fmax(velocity, -0.07), 0.07);
            position += velocity;
            position = fmin(fmax(position, -1.2), 0.6);
            if (position == -1.2 && velocity < 0)
                velocity = 0.0;
            done = position >= 0.5 && velocity >= 0.0;
            double *next = cell(q, position, velocity);
            if (done)
                values[action] = -1.0;
            else
                values[action] += learning_rate * (-1.0 + discount * next[greedy(next)] - values[action]);
            values = next;
            steps++;
        }
        if (epsilon > min_epsilon)
            epsilon -= reduction;
    }
    return steps;
}

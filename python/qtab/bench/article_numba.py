"""The article's training loop with MountainCar's physics, written so that numba can compile it."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

EPISODES = 5000


def q_learning(
    starts: NDArray[np.float64],
    seed: int,
    learning_rate: float,
    discount: float,
    epsilon: float,
    min_epsilon: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Trains one episode from each start position.

    Returns:
        The Q table, (19, 15, 3); (episodes,) returns; and the number of steps.
    """
    np.random.seed(seed)  # noqa: NPY002 - numba supports NumPy's global generator, which the article uses
    Q = np.random.uniform(-1.0, 1.0, (19, 15, 3))  # noqa: N806, NPY002 - the book's symbol
    returns = np.zeros(len(starts))
    reduction = (epsilon - min_epsilon) / len(starts)
    low_position, low_velocity = np.float32(-1.2), np.float32(-0.07)
    steps = 0

    for episode in range(len(starts)):
        position, velocity = starts[episode], 0.0
        row = int(np.round(np.float64(np.float32(position) - low_position) * 10.0))
        column = int(np.round(np.float64(np.float32(velocity) - low_velocity) * 100.0))
        terminated = False
        length = 0

        while not terminated and length < 200:
            if np.random.random() < 1.0 - epsilon:  # noqa: NPY002
                action = int(np.argmax(Q[row, column]))
            else:
                action = int(np.random.randint(0, 3))  # noqa: NPY002

            velocity += (action - 1) * 0.001 + math.cos(3 * position) * (-0.0025)
            velocity = min(max(velocity, -0.07), 0.07)
            position += velocity
            position = min(max(position, -1.2), 0.6)
            if position == -1.2 and velocity < 0:
                velocity = 0.0
            terminated = position >= 0.5 and velocity >= 0.0

            next_row = int(np.round(np.float64(np.float32(position) - low_position) * 10.0))
            next_column = int(np.round(np.float64(np.float32(velocity) - low_velocity) * 100.0))
            if terminated:
                Q[row, column, action] = -1.0
            else:
                target = -1.0 + discount * np.max(Q[next_row, next_column])
                Q[row, column, action] += learning_rate * (target - Q[row, column, action])

            row, column = next_row, next_column
            returns[episode] -= 1.0
            length += 1

        steps += length
        if epsilon > min_epsilon:
            epsilon -= reduction
    return Q, returns, steps


def compiled_many(threads: int) -> Callable[[int], int] | None:
    """Returns a function from a number of seeds to the steps of their runs, on several threads; None without numba."""
    try:
        from numba import njit, prange, set_num_threads
    except ModuleNotFoundError:
        return None
    fast: Any = njit(q_learning)

    def runs(starts: NDArray[np.float64], steps: NDArray[np.int64]) -> None:
        for seed in prange(len(starts)):
            _, _, steps[seed] = fast(starts[seed], seed, 0.2, 0.9, 0.8, 0.0)

    parallel: Any = njit(parallel=True)(runs)

    def run(seeds: int) -> int:
        set_num_threads(threads)
        starts = np.random.default_rng(0).uniform(-0.6, -0.4, (seeds, EPISODES))
        steps = np.zeros(seeds, np.int64)
        parallel(starts, steps)
        return int(steps.sum())

    return run


def compiled() -> Callable[[int], int] | None:
    """Returns a function from the seed of a run, compiled by numba, to its number of steps; None without numba."""
    try:
        from numba import njit
    except ModuleNotFoundError:
        return None
    fast: Any = njit(q_learning)

    def run(seed: int) -> int:
        starts = np.random.default_rng(seed).uniform(-0.6, -0.4, EPISODES)
        _, _, steps = fast(starts, seed, 0.2, 0.9, 0.8, 0.0)
        return int(steps)

    return run

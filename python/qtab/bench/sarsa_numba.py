"""Sarsa(λ) on tile coding, with MountainCar's physics, plain enough for numba: compiled Python beside the learners."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

EPISODES = 500
TILINGS, TILES = 8, 8
SIDE = TILES + 1

Look = Callable[[float, float, NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]], int]


def look(
    position: float,
    velocity: float,
    Q: NDArray[np.float64],  # noqa: N803 - the book's
    rows: NDArray[np.int64],
    values: NDArray[np.float64],
) -> int:
    """Fills in the rows that a state lights and the values of its actions, and returns the greedy action."""
    low_position, high_position = np.float64(np.float32(-1.2)), np.float64(np.float32(0.6))
    low_velocity, high_velocity = np.float64(np.float32(-0.07)), np.float64(np.float32(0.07))
    along = (np.float64(np.float32(position)) - low_position) * (TILES / (high_position - low_position)) * TILINGS
    up = (np.float64(np.float32(velocity)) - low_velocity) * (TILES / (high_velocity - low_velocity)) * TILINGS
    column, line = math.floor(along), math.floor(up)
    values[:] = 0.0
    for tiling in range(TILINGS):
        across = (column + tiling) // TILINGS
        row = (tiling * SIDE + across) * SIDE + (line + tiling * 3 % TILINGS) // TILINGS
        rows[tiling] = row
        for action in range(3):
            values[action] += Q[row, action]
    np.random.random()  # noqa: NPY002 - whether to explore: never
    return int(np.argmax(values))


def sarsa_lambda(
    look: Look, starts: NDArray[np.float64], seed: int, learning_rate: float, trace_decay: float, trace_cutoff: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Returns the Q table, each episode's return and the number of steps; an episode for each start position.

    Nothing is explored or discounted; traces are replacing, and only those alive are visited.
    """
    np.random.seed(seed)  # noqa: NPY002 - numba's own stream
    Q = np.zeros((TILINGS * SIDE * SIDE, 3))  # noqa: N806 - the book's
    z = np.zeros_like(Q)
    alive = np.zeros((Q.size, 2), dtype=np.int64)
    here, there, values = np.zeros(TILINGS, dtype=np.int64), np.zeros(TILINGS, dtype=np.int64), np.zeros(3)
    returns = np.zeros(len(starts))
    steps = 0

    for episode in range(len(starts)):
        position, velocity = starts[episode], 0.0
        action = next_action = look(position, velocity, Q, here, values)
        terminated = False
        length = traces = 0

        while not terminated and length < 200:
            velocity += (action - 1) * 0.001 + math.cos(3 * position) * (-0.0025)
            velocity = min(max(velocity, -0.07), 0.07)
            position += velocity
            position = min(max(position, -1.2), 0.6)
            if position == -1.2 and velocity < 0:
                velocity = 0.0
            terminated = position >= 0.5 and velocity >= 0.0

            value = 0.0
            for row in here:
                if z[row, action] == 0.0:
                    alive[traces, 0], alive[traces, 1] = row, action
                    traces += 1
                z[row, action] = 1.0
                value += Q[row, action]
            target = -1.0
            if not terminated:
                next_action = look(position, velocity, Q, there, values)
                target += values[next_action]

            step = learning_rate / TILINGS * (target - value)
            left = 0
            for index in range(traces):
                row, of = alive[index, 0], alive[index, 1]
                Q[row, of] += step * z[row, of]
                z[row, of] *= trace_decay
                if z[row, of] <= trace_cutoff:
                    z[row, of] = 0.0
                else:
                    alive[left, 0], alive[left, 1] = row, of
                    left += 1
            traces = left

            here[:] = there
            action = next_action
            returns[episode] -= 1.0
            length += 1

        for index in range(traces):
            z[alive[index, 0], alive[index, 1]] = 0.0
        steps += length
    return Q, returns, steps


def compiled(trace_decay: float, trace_cutoff: float) -> Callable[[int], int] | None:
    """Returns a whole run under numba, by seed, that returns its number of steps; None without numba."""
    try:
        from numba import njit
    except ModuleNotFoundError:
        return None
    fast: Any = njit(sarsa_lambda)
    inner: Any = njit(look)

    def run(seed: int) -> int:
        starts = np.random.default_rng(seed).uniform(-0.6, -0.4, EPISODES)
        _, _, steps = fast(inner, starts, seed, 0.3, trace_decay, trace_cutoff)
        return int(steps)

    return run

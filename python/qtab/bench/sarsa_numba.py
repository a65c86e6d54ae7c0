"""Sarsa(λ) with tile coding and MountainCar's physics, written so that numba can compile it."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

EPISODES = 500
TILINGS, TILES = 8, 8
SIDE = TILES + 1

Observe = Callable[[float, float, NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]], int]


def observe(
    position: float,
    velocity: float,
    Q: NDArray[np.float64],  # noqa: N803 - the book's symbol
    rows: NDArray[np.int64],
    values: NDArray[np.float64],
) -> int:
    """Computes the active rows and the action values of a state, and returns the greedy action.

    Args:
        position: The position of the car.
        velocity: The velocity of the car.
        Q: (rows, 3): the Q table.
        rows: (tilings,): receives the active rows.
        values: (3,): receives the action values.
    """
    low_position, high_position = np.float64(np.float32(-1.2)), np.float64(np.float32(0.6))
    low_velocity, high_velocity = np.float64(np.float32(-0.07)), np.float64(np.float32(0.07))
    x = (np.float64(np.float32(position)) - low_position) * (TILES / (high_position - low_position)) * TILINGS
    y = (np.float64(np.float32(velocity)) - low_velocity) * (TILES / (high_velocity - low_velocity)) * TILINGS
    column, line = math.floor(x), math.floor(y)
    values[:] = 0.0
    for tiling in range(TILINGS):
        tile_x = (column + tiling) // TILINGS
        row = (tiling * SIDE + tile_x) * SIDE + (line + tiling * 3 % TILINGS) // TILINGS
        rows[tiling] = row
        for action in range(3):
            values[action] += Q[row, action]
    np.random.random()  # noqa: NPY002 - the draw for exploration, whose rate is 0
    return int(np.argmax(values))


def sarsa_lambda(
    observe: Observe,
    starts: NDArray[np.float64],
    seed: int,
    learning_rate: float,
    trace_decay: float,
    trace_cutoff: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Trains one episode from each start position, with ε = 0, no discount and replacing traces.

    Only the nonzero traces are visited.

    Returns:
        The Q table, (rows, 3); (episodes,) returns; and the number of steps.
    """
    np.random.seed(seed)  # noqa: NPY002 - numba supports NumPy's global generator
    Q = np.zeros((TILINGS * SIDE * SIDE, 3))  # noqa: N806 - the book's symbol
    z = np.zeros_like(Q)
    active = np.zeros((Q.size, 2), dtype=np.int64)
    rows, next_rows = np.zeros(TILINGS, dtype=np.int64), np.zeros(TILINGS, dtype=np.int64)
    values = np.zeros(3)
    returns = np.zeros(len(starts))
    steps = 0

    for episode in range(len(starts)):
        position, velocity = starts[episode], 0.0
        action = next_action = observe(position, velocity, Q, rows, values)
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
            for row in rows:
                if z[row, action] == 0.0:
                    active[traces, 0], active[traces, 1] = row, action
                    traces += 1
                z[row, action] = 1.0
                value += Q[row, action]
            target = -1.0
            if not terminated:
                next_action = observe(position, velocity, Q, next_rows, values)
                target += values[next_action]

            step = learning_rate / TILINGS * (target - value)
            kept = 0
            for index in range(traces):
                row, column = active[index, 0], active[index, 1]
                Q[row, column] += step * z[row, column]
                z[row, column] *= trace_decay
                if z[row, column] <= trace_cutoff:
                    z[row, column] = 0.0
                else:
                    active[kept, 0], active[kept, 1] = row, column
                    kept += 1
            traces = kept

            rows[:] = next_rows
            action = next_action
            returns[episode] -= 1.0
            length += 1

        for index in range(traces):
            z[active[index, 0], active[index, 1]] = 0.0
        steps += length
    return Q, returns, steps


def compiled(trace_decay: float, trace_cutoff: float) -> Callable[[int], int] | None:
    """Returns a function from the seed of a run, compiled by numba, to its number of steps; None without numba."""
    try:
        from numba import njit
    except ModuleNotFoundError:
        return None
    fast: Any = njit(sarsa_lambda)
    compiled_observe: Any = njit(observe)

    def run(seed: int) -> int:
        starts = np.random.default_rng(seed).uniform(-0.6, -0.4, EPISODES)
        _, _, steps = fast(compiled_observe, starts, seed, 0.3, trace_decay, trace_cutoff)
        return int(steps)

    return run

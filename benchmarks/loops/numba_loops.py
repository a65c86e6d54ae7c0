"""The article's training loop and Sarsa(λ) with tile coding, on MountainCar, written for Numba.

Without Numba they are plain Python functions and are not timed.
"""

import math
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

numba: Any = import_module("numba") if find_spec("numba") else None
prange: Any = numba.prange if numba else range

EPISODES = 5000
"""The episodes of a run of the article's loop."""
TILINGS, TILES = 8, 8
SIDE = TILES + 1

F = TypeVar("F", bound=Callable[..., Any])


def compiles() -> bool:
    """Whether Numba is installed and compiles, which the environment variable NUMBA_DISABLE_JIT turns off."""
    return bool(numba) and not numba.config.DISABLE_JIT


def compiled(function: F) -> F:
    """Returns the function as Numba compiles it at its first call."""
    compiled_function: F = numba.njit(function) if numba else function
    return compiled_function


@compiled
def step(position: float, velocity: float, action: int) -> tuple[float, float, bool]:
    """MountainCar's physics: returns the position, the velocity and whether the goal is reached."""
    velocity += (action - 1) * 0.001 + math.cos(3 * position) * (-0.0025)
    velocity = min(max(velocity, -0.07), 0.07)
    position += velocity
    position = min(max(position, -1.2), 0.6)
    if position == -1.2 and velocity < 0:
        velocity = 0.0
    return position, velocity, position >= 0.5 and velocity >= 0.0


@compiled
def cell(position: float, velocity: float) -> tuple[int, int]:
    """Returns the article's cell of a state."""
    row = int(np.round(np.float64(np.float32(position) - np.float32(-1.2)) * 10.0))
    column = int(np.round(np.float64(np.float32(velocity) - np.float32(-0.07)) * 100.0))
    return row, column


@compiled
def q_learning(starts: NDArray[np.float64], seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Trains as the article does, one episode from each start position.

    Returns:
        The Q table, (19, 15, 3); (episodes,) returns; and the number of steps.
    """
    np.random.seed(seed)  # noqa: NPY002 - numba supports NumPy's global generator, which the article uses
    Q = np.random.uniform(-1.0, 1.0, (19, 15, 3))  # noqa: N806, NPY002 - the book's symbol
    returns = np.zeros(len(starts))
    epsilon, reduction, steps = 0.8, 0.8 / len(starts), 0
    for episode in range(len(starts)):
        position, velocity = starts[episode], 0.0
        row, column = cell(position, velocity)
        terminated, length = False, 0
        while not terminated and length < 200:
            if np.random.random() < 1.0 - epsilon:  # noqa: NPY002
                action = int(np.argmax(Q[row, column]))
            else:
                action = int(np.random.randint(0, 3))  # noqa: NPY002
            position, velocity, terminated = step(position, velocity, action)
            next_row, next_column = cell(position, velocity)
            if terminated:
                Q[row, column, action] = -1.0
            else:
                target = -1.0 + 0.9 * np.max(Q[next_row, next_column])
                Q[row, column, action] += 0.2 * (target - Q[row, column, action])
            row, column = next_row, next_column
            returns[episode] -= 1.0
            length += 1
        steps += length
        if epsilon > 0.0:
            epsilon -= reduction
    return Q, returns, steps


def _many(starts: NDArray[np.float64], steps: NDArray[np.int64]) -> None:
    for seed in prange(len(starts)):
        _, _, steps[seed] = q_learning(starts[seed], seed)


parallel: Any = numba.njit(parallel=True)(_many) if numba else _many


def single_run(seed: int) -> int:
    """Trains with the article's loop and returns the number of steps."""
    return int(q_learning(np.random.default_rng(seed).uniform(-0.6, -0.4, EPISODES), seed)[2])


def many_runs(seeds: int, threads: int) -> int:
    """Trains with several seeds on several threads and returns the number of steps."""
    if numba:
        numba.set_num_threads(threads)
    starts = np.random.default_rng(0).uniform(-0.6, -0.4, (seeds, EPISODES))
    steps = np.zeros(seeds, np.int64)
    parallel(starts, steps)
    return int(steps.sum())


@compiled
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


@compiled
def sarsa_lambda(
    starts: NDArray[np.float64], seed: int, trace_cutoff: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Trains one episode from each start position: ε = 0, α = 0.3, λ = 0.9, no discount, replacing traces.

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
            position, velocity, terminated = step(position, velocity, action)
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
            change = 0.3 / TILINGS * (target - value)
            kept = 0
            for index in range(traces):
                row, column = active[index, 0], active[index, 1]
                Q[row, column] += change * z[row, column]
                z[row, column] *= 0.9
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

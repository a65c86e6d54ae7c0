"""Sarsa with a Fourier basis, on MountainCar, written for Numba: with qtab's operations, or with a cosine a feature."""

import math

import numpy as np
from numpy.typing import NDArray

from loops.numba_loops import compiled, step

ORDER = 5
FEATURES = (ORDER + 1) ** 2
LEARNING_RATE = 0.001
MAX_STEPS = 200


@compiled
def compute_powers(s: float, re: NDArray[np.float64], im: NDArray[np.float64]) -> None:
    """Computes the real and the imaginary parts of the powers of e^(iπs), from 0 to the order."""
    re[0], im[0] = 1.0, 0.0
    re[1], im[1] = math.cos(math.pi * s), math.sin(math.pi * s)
    for k in range(2, ORDER + 1):
        m, n = k // 2, k - k // 2
        re[k] = re[n] * re[m] - im[n] * im[m]
        im[k] = re[n] * im[m] + im[n] * re[m]


@compiled
def observe(
    position: float,
    velocity: float,
    W: NDArray[np.float64],  # noqa: N803 - a matrix
    x: NDArray[np.float64],
    values: NDArray[np.float64],
    powers: NDArray[np.float64],
    by_cosines: bool,
) -> int:
    """Computes the features and the action values of a state, and returns the greedy action.

    Args:
        position: The position of the car.
        velocity: The velocity of the car.
        W: (features, 3): the weights.
        x: (features,): receives the features.
        values: (3,): receives the action values.
        powers: (4, order + 1): room for the powers.
        by_cosines: Whether to compute the cosine of each feature, instead of products of powers.
    """
    low_position, high_position = np.float64(np.float32(-1.2)), np.float64(np.float32(0.6))
    low_velocity, high_velocity = np.float64(np.float32(-0.07)), np.float64(np.float32(0.07))
    s_0 = (np.float64(np.float32(position)) - low_position) / (high_position - low_position)
    s_1 = (np.float64(np.float32(velocity)) - low_velocity) / (high_velocity - low_velocity)
    if not by_cosines:
        compute_powers(s_0, powers[0], powers[1])
        compute_powers(s_1, powers[2], powers[3])
    for i in range(ORDER + 1):
        for j in range(ORDER + 1):
            if by_cosines:
                x[i * (ORDER + 1) + j] = math.cos(math.pi * (i * s_0 + j * s_1))
            else:
                x[i * (ORDER + 1) + j] = powers[0, i] * powers[2, j] - powers[1, i] * powers[3, j]
    for action in range(3):
        values[action] = product(W, x, action)
    np.random.random()  # noqa: NPY002 - the draw for exploration, whose rate is 0
    return int(np.argmax(values))


@compiled
def product(W: NDArray[np.float64], x: NDArray[np.float64], action: int) -> float:  # noqa: N803 - a matrix
    """Returns the value of an action: four partial sums, whose additions do not wait for each other."""
    sums = (0.0, 0.0, 0.0, 0.0)
    for i in range(0, FEATURES, 4):
        sums = (
            sums[0] + W[i, action] * x[i],
            sums[1] + W[i + 1, action] * x[i + 1],
            sums[2] + W[i + 2, action] * x[i + 2],
            sums[3] + W[i + 3, action] * x[i + 3],
        )
    return (sums[0] + sums[1]) + (sums[2] + sums[3])


@compiled
def sarsa(
    starts: NDArray[np.float64], seed: int, by_cosines: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    """Trains with a discount of 1 and no exploration, one episode from each start position.

    Returns:
        The weights, (features, 3); (episodes,) returns; and the number of steps.
    """
    np.random.seed(seed)  # noqa: NPY002 - numba supports NumPy's global generator
    W = np.zeros((FEATURES, 3))  # noqa: N806 - a matrix
    rates = np.full(FEATURES, LEARNING_RATE)
    for index in range(1, FEATURES):
        rates[index] /= math.sqrt((index // (ORDER + 1)) ** 2 + (index % (ORDER + 1)) ** 2)
    x, next_x, values, powers = np.zeros(FEATURES), np.zeros(FEATURES), np.zeros(3), np.zeros((4, ORDER + 1))
    returns, steps = np.zeros(len(starts)), 0
    for episode in range(len(starts)):
        position, velocity = starts[episode], 0.0
        action = observe(position, velocity, W, x, values, powers, by_cosines)
        terminated, length = False, 0
        while not terminated and length < MAX_STEPS:
            position, velocity, terminated = step(position, velocity, action)
            next_action = observe(position, velocity, W, next_x, values, powers, by_cosines)
            target = -1.0 if terminated else -1.0 + values[next_action]
            error = target - product(W, x, action)
            for index in range(FEATURES):
                W[index, action] += rates[index] * error * x[index]
            x, next_x, action = next_x, x, next_action
            length += 1
        returns[episode] = -length
        steps += length
    return W, returns, steps

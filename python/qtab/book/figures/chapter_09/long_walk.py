"""Gradient Monte Carlo with feature vectors on the random walk of 1,000 states, for many runs at once in NumPy."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from qtab.book.runner import FloatArray

STATES, REACH = 1000, 100
START = (STATES - 1) // 2
LEFT_END, RIGHT_END = -1, -2
BLOCK = 4096
"""The number of random numbers that are drawn at a time."""


class Steps(NamedTuple):
    """The steps of a run, one episode after another."""

    states: NDArray[np.int64]
    """(steps,): the state of each step."""
    returns: FloatArray
    """(steps,): the return of its episode, which is the reward of the last step."""
    ends: NDArray[np.int64]
    """(episodes,): the number of steps up to the end of each episode."""


def simulate(seeds: Sequence[int], episodes: int, on_episodes: Callable[[int], None] | None = None) -> list[Steps]:
    """Returns the steps of each run under the random policy.

    The states are those of :func:`qtab.estimate_values` with ``qtab/RandomWalk-v0``: the environment's generator draws
    a number for each reset and each step, and the agent's generator one for each action.

    Args:
        seeds: The seed of each run.
        episodes: The number of episodes of each run.
        on_episodes: Called from time to time with the number of episodes that all runs have finished.
    """
    runs = len(seeds)
    of_env = [np.random.default_rng(seed) for seed in seeds]
    of_agent = [np.random.default_rng(np.random.SeedSequence(seed).spawn(1)[0]) for seed in seeds]
    directions = np.stack([_directions(rng, BLOCK) for rng in of_agent])
    # A step of each length is equally likely; the probabilities are added one by one, as in the environment.
    lengths = np.cumsum(np.full(REACH, 1.0 / REACH))
    every, state, resets = np.arange(runs), np.full(runs, LEFT_END), np.zeros(runs, np.int64)
    blocks: list[NDArray[np.int64]] = []
    while (resets <= episodes).any():
        draws = np.stack([rng.random(BLOCK) for rng in of_env], axis=1)
        distances = np.minimum(np.searchsorted(lengths, draws, side="right"), REACH - 1) + 1
        block, taken = np.empty((BLOCK, runs), np.int64), np.zeros(runs, np.int64)
        for row, distance in enumerate(distances):
            block[row] = state
            stepping = state >= 0
            following = np.maximum(state + directions[every, taken] * distance, LEFT_END)
            following[following >= STATES] = RIGHT_END
            state = np.where(stepping, following, START)
            taken += stepping
        blocks.append(block)
        resets += (block < 0).sum(axis=0)
        for run, rng in enumerate(of_agent):
            directions[run] = np.concatenate((directions[run, taken[run] :], _directions(rng, int(taken[run]))))
        if on_episodes is not None:
            on_episodes(int(min(resets.min(), episodes)))
    return [_steps(column, episodes) for column in np.concatenate(blocks).T]


def _directions(rng: np.random.Generator, count: int) -> NDArray[np.int64]:
    """Returns the directions of actions: -1 for left, with probability 1/2, and 1 for right."""
    return np.where(rng.random(count) < 0.5, -1, 1)


def _steps(places: NDArray[np.int64], episodes: int) -> Steps:
    """Returns the steps of a run, given a state for each step and the end of the last episode for each reset."""
    resets = np.flatnonzero(places < 0)[: episodes + 1]
    lengths = np.diff(resets) - 1
    rewards = np.where(places[resets[1:]] == RIGHT_END, 1.0, -1.0)
    states = places[: resets[-1]]
    return Steps(states[states >= 0], np.repeat(rewards, lengths), np.cumsum(lengths))


def gradient_monte_carlo(
    runs: Sequence[Steps],
    features: Sequence[FloatArray],
    alphas: Sequence[float],
    record: Sequence[int],
    on_steps: Callable[[int], None] | None = None,
) -> list[FloatArray]:
    """Returns the values of each method, (runs, points, states): w <- w + α [G - wᵀx] x for each step in order.

    Section 9.3, gradient Monte Carlo. The weights begin at zero.

    Args:
        runs: The steps of each run.
        features: (states, d) for each method: the feature vectors.
        alphas: The step size of each method.
        record: The numbers of episodes after which the values are kept, ascending.
        on_steps: Called from time to time with the number of steps that all runs have taken.
    """
    # All methods and runs take their steps at the same time, each run at its own place in its episodes.
    together = np.concatenate(features, axis=1)
    widths = [one.shape[1] for one in features]
    first = np.cumsum([0, *widths[:-1]])
    method = np.repeat(np.arange(len(features)), widths)
    longest = max(len(run.states) for run in runs)
    states, returns = np.zeros((longest, len(runs)), np.int64), np.zeros((longest, len(runs)))
    due: dict[int, list[tuple[int, int]]] = {}
    for index, run in enumerate(runs):
        # After its last step, a run goes on without effect: its values have been kept.
        states[: len(run.states), index], returns[: len(run.states), index] = run.states, run.returns
        for point, episodes in enumerate(record):
            due.setdefault(int(run.ends[episodes - 1]) if episodes else 0, []).append((index, point))
    weights = np.zeros((len(runs), together.shape[1]))
    kept = np.zeros((len(runs), len(record), together.shape[1]))
    rates = np.array(alphas)
    for step in range(longest + 1):
        if on_steps is not None and step % BLOCK == 0:
            on_steps(step)
        for index, point in due.get(step, ()):
            kept[index, point] = weights[index]
        if step < longest:
            x = together.take(states[step], axis=0)
            values = np.add.reduceat(weights * x, first, axis=1)
            errors = rates * (returns[step][:, None] - values)
            weights += errors.take(method, axis=1) * x
    parts = np.split(kept, first[1:], axis=2)
    return [part @ one.T for part, one in zip(parts, features, strict=True)]

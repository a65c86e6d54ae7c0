"""Compare the speed of qtab.train with the article's plain loop, in interleaved rounds of one process."""

import time
from argparse import Namespace
from collections.abc import Callable, Mapping
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.versions import versions
from qtab.cli.errors import UsageError, usage_errors
from qtab.cli.parser import Parser
from qtab.cli.reporting import Report
from qtab.cli.values import integer, number
from qtab.reference import agent_stream
from qtab.training.train import train

ARTICLE, TRAIN = "the article's loop (NumPy on gymnasium.make)", "qtab.train"
ENV, EPISODES = "MountainCar-v0", 10
"""The environment, and the episodes of the article's loop in a round, to which its schedule is compressed."""


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    parser.output_flags()
    parser.option("seconds", number, "The approximate duration; there are at least three rounds.", 10.0)
    parser.option("rounds", integer, "The number of rounds; by default as many as fit into the duration.")
    parser.option("part", str, "Must be training: python benchmarks/compare.py, in the repository, times other parts.")


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    if options.part not in (None, "training"):
        others = "python benchmarks/compare.py, in the repository, times the other parts"
        raise UsageError(f"--part must be training, got {options.part!r:.100}; {others}")
    with Report(options) as report:
        with usage_errors(options):
            seconds = checks.real("seconds", options.seconds, 0, 86_400)
            rounds = None if options.rounds is None else checks.integer("rounds", options.rounds, least=1)
        times = measure(BENCHMARKS, seconds, rounds)
        medians = {name: float(np.median(found)) for name, found in times.items()}
        ratio, rounds = np.median(times[ARTICLE] / times[TRAIN]), len(times[TRAIN])
        report.text(
            f"A step of {ENV} takes {medians[ARTICLE]:,.0f} ns in {ARTICLE} and {medians[TRAIN]:.1f} ns in {TRAIN}, "
            f"which is {ratio:,.0f} times as fast (medians of {rounds} round{'' if rounds == 1 else 's'})\n"
            f"{', '.join(f'{name} {value}' for name, value in versions().items())}"
        )
        found = {name: {"ns_per_step": medians[name], "rounds": times[name]} for name in times}
        report.add(benchmarks=found, rounds=rounds, versions=versions())
    return 0


def measure(
    benchmarks: Mapping[str, Callable[[int], int]], seconds: float, rounds: int | None
) -> dict[str, NDArray[np.float64]]:
    """Returns the nanoseconds per step of benchmarks in each round, (rounds,), after a round that is not counted.

    In a round all benchmarks take turns, so that a slow moment of the machine affects all of them.

    Args:
        benchmarks: Functions from the number of a round to the number of steps made, by name.
        seconds: The approximate duration, if ``rounds`` is None; there are at least three rounds.
        rounds: The number of rounds.
    """
    times: list[list[float]] = []
    began = time.perf_counter()
    while len(times) < 1 + (rounds or 3) or (rounds is None and time.perf_counter() < began + seconds):
        times.append([])
        for benchmark in benchmarks.values():
            started = time.perf_counter_ns()
            steps = benchmark(len(times) - 1)
            times[-1].append((time.perf_counter_ns() - started) / steps)
    return dict(zip(benchmarks, np.transpose(times[1:]), strict=True))


def q_learning(episodes: int, seed: int) -> tuple[NDArray[np.float64], int]:
    """Runs the article's training loop with its settings, on NumPy and Gymnasium's environment only.

    Returns:
        The Q table, (19, 15, 3), and the number of steps.
    """
    learning, discount, epsilon, min_eps = 0.2, 0.9, 0.8, 0.0
    env, rng = gym.make(ENV), agent_stream(seed, "PCG64")
    space: Any = env.observation_space
    low, scale = space.low, np.array([10, 100])
    n_cells = np.round((space.high - low) * scale, 0).astype(int) + 1
    q = rng.uniform(-1, 1, size=(*n_cells, 3))
    reduction = (epsilon - min_eps) / episodes
    steps = 0
    for episode in range(episodes):
        state, _ = env.reset(seed=seed if episode == 0 else None)
        cell = tuple(np.round((state - low) * scale, 0).astype(int))
        done = truncated = False
        while not (done or truncated):
            if rng.random() < 1.0 - epsilon:
                action = int(np.argmax(q[cell]))
            else:
                action = int(rng.integers(0, 3))
            state, reward, done, truncated, _ = env.step(action)
            next_cell = tuple(np.round((state - low) * scale, 0).astype(int))
            if done:
                q[cell][action] = reward
            else:
                q[cell][action] += learning * (reward + discount * np.max(q[next_cell]) - q[cell][action])
            cell = next_cell
            steps += 1
        if epsilon > min_eps:
            epsilon -= reduction
    return q, steps


BENCHMARKS: Mapping[str, Callable[[int], int]] = {
    ARTICLE: lambda seed: q_learning(EPISODES, seed)[1],
    TRAIN: lambda seed: int(train(ENV, seed=seed, progress=False).episode_lengths.sum()),
}
"""Functions from a seed to the number of steps of its run."""

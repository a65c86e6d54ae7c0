"""Prints the tables of docs/reference/environments.md, every preset over 100 seeds, in a minute or two.

With an environment, those of one preset over other seeds:

    python docs/reference/environments.py MountainCar-v0 solved --first-seed 10000 --seeds 1000
"""

import argparse
from typing import TypeAlias

import gymnasium as gym
import numpy as np

import qtab
from qtab.envs.registry import ENTRIES
from qtab.results.summary import best_mean_returns

SEEDS = 100
GREEDY_EPISODES = 1_000
Cells: TypeAlias = tuple[str, ...]

COLUMNS: Cells = ("environment", "preset", "algorithm", "episodes", "last 100", "seeds solved")
COLUMNS += ("greedy", "threshold", "optimum")
FRESH_COLUMNS: Cells = ("environment", "preset", "seeds", "last 100", "worst seed", "solved", "solved at the end")


def row(env: str, preset: str, optimum: qtab.Optimum | None) -> Cells:
    """Trains a preset with every seed and returns its row of the table."""
    runs = qtab.train_many(env, SEEDS, preset=preset, tables=True)
    threshold = gym.spec(env).reward_threshold
    return (
        env,
        preset,
        runs.config.algorithm,
        f"{runs.config.episodes:,}",
        average(runs.final_returns(100)),
        "" if threshold is None else str(np.count_nonzero(best_mean_returns(runs.episode_returns) >= threshold)),
        average(greedy_returns(runs, optimum)),
        "" if threshold is None else f"{threshold:g}",
        "" if optimum is None else f"{optimum.expected_return:.4g}" + ("" if optimum.exact else f" ({optimum.label})"),
    )


def fresh_row(env: str, preset: str, seeds: range) -> Cells:
    """Trains a preset with seeds on which it was not chosen; of an environment with a threshold."""
    runs = qtab.train_many(env, seeds, preset=preset)
    threshold, last = gym.spec(env).reward_threshold, runs.final_returns(100)
    assert threshold is not None, f"{env} has no threshold"  # noqa: S101 - a script of this repository
    solved = np.count_nonzero(best_mean_returns(runs.episode_returns) >= threshold)
    return (
        env,
        preset,
        f"{seeds[0]:,} to {seeds[-1]:,}",
        f"{last.mean():.2f}",
        f"{last.min():.2f}",
        f"{solved:,} of {len(seeds):,}",
        f"{np.count_nonzero(last >= threshold):,} of {len(seeds):,}",
    )


def greedy_returns(runs: qtab.Runs, optimum: qtab.Optimum | None) -> np.typing.ArrayLike:
    """Returns each greedy policy's expected return: exact if the transition table is known, else estimated."""
    if optimum is not None and optimum.exact:
        return optimum.gap(runs).greedy_return
    played = (qtab.evaluate(run, GREEDY_EPISODES, seed=index) for index, run in enumerate(runs))
    return [evaluation.mean_return for evaluation in played]


def average(values: np.typing.ArrayLike) -> str:
    """Formats the mean over seeds and its standard error."""
    error = np.std(values, ddof=1) / np.sqrt(np.size(values))
    return f"{np.mean(values):.4g}" + (f" ± {error:.1g}" if error > 1e-9 else "")


def known_optimum(env: str) -> qtab.Optimum | None:
    """Returns the optimum, or the best known policy; None if neither is available."""
    try:
        return qtab.optimum(env)
    except ValueError:
        return None


def print_row(cells: Cells) -> None:
    """Prints a row in Markdown."""
    print("| " + " | ".join(cells) + " |", flush=True)


parser = argparse.ArgumentParser()
parser.add_argument("env", nargs="?")
parser.add_argument("preset", nargs="?", default="solved")
parser.add_argument("--first-seed", type=int, default=10_000)
parser.add_argument("--seeds", type=int, default=1000)
asked = parser.parse_args()
columns = COLUMNS if asked.env is None else FRESH_COLUMNS
print_row(columns)
print("|---" * len(columns) + "|")
if asked.env is not None:
    print_row(fresh_row(asked.env, asked.preset, range(asked.first_seed, asked.first_seed + asked.seeds)))
else:
    for env in ENTRIES:
        if presets := qtab.presets(env):
            optimum = known_optimum(env)
            for preset in presets:
                print_row(row(env, preset, optimum))

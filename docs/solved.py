"""Prints the tables of docs/environments.md: the results of every preset over 100 seeds, which takes a few minutes.

python docs/solved.py MountainCar-v0 solved --first-seed 10000 --seeds 1000 prints those of one preset over other seeds.
"""

import argparse

import gymnasium as gym
import numpy as np

import qtab
from qtab.envs.registry import ENTRIES
from qtab.results.summary import best_mean_returns

GREEDY_EPISODES = 1_000

COLUMNS = ("environment", "preset", "algorithm", "episodes", "last 100", "worst seed")
COLUMNS += ("seeds solved", "at the end", "greedy", "threshold", "optimum")


def row(env: str, preset: str, optimum: qtab.Optimum | None, seeds: range) -> str:
    """Trains a preset with every seed and returns its row of the table."""
    runs = qtab.train_many(env, seeds, preset=preset, tables=True)
    threshold, last = gym.spec(env).reward_threshold, runs.final_returns(100)
    cells = (
        env,
        preset,
        runs.config.algorithm,
        f"{runs.config.episodes:,}",
        average(last),
        f"{last.min():.4g}",
        "" if threshold is None else str(np.count_nonzero(best_mean_returns(runs.episode_returns) >= threshold)),
        "" if threshold is None else str(np.count_nonzero(last >= threshold)),
        average(greedy_returns(runs, optimum)),
        "" if threshold is None else f"{threshold:g}",
        "" if optimum is None else f"{optimum.expected_return:.4g}" + ("" if optimum.exact else f" ({optimum.label})"),
    )
    return "| " + " | ".join(cells) + " |"


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


parser = argparse.ArgumentParser()
parser.add_argument("env", nargs="?")
parser.add_argument("preset", nargs="?")
parser.add_argument("--first-seed", type=int, default=0)
parser.add_argument("--seeds", type=int, default=100)
asked = parser.parse_args()
seeds = range(asked.first_seed, asked.first_seed + asked.seeds)
print("| " + " | ".join(COLUMNS) + " |")
print("|---" * len(COLUMNS) + "|")
for env in ENTRIES if asked.env is None else [asked.env]:
    if presets := qtab.presets(env):
        optimum = known_optimum(env)
        for preset in presets if asked.preset is None else [asked.preset]:
            print(row(env, preset, optimum, seeds), flush=True)

"""Prints the tables of docs/reference/environments.md, with every preset over fresh seeds.

With an environment and a preset, it prints one row of each:

    python docs/reference/environments.py MountainCar-v0 solved
"""

import argparse
from typing import TypeAlias

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike

import qtab
from qtab.envs.registry import ENTRIES
from qtab.results.summary import best_mean_returns

ENVIRONMENTS = (*ENTRIES, "LunarLander-v3", "qtab/Racetrack-v0")
NO_SEEDS = range(0)
SEEDS = {
    ("MountainCar-v0", "solved"): (range(20_000, 20_200), range(40_000, 41_000)),
    ("CartPole-v1", "solved"): (range(20_300, 20_500), range(70_000, 71_000)),
    ("CartPole-v0", "solved"): (NO_SEEDS, range(60_000, 60_040)),
    ("Acrobot-v1", "solved"): (range(20_000, 20_016), range(60_000, 60_100)),
    ("Pendulum-v1", "tuned"): (range(20_000, 20_016), range(60_000, 60_200)),
    ("LunarLander-v3", "solved"): (range(20_000, 20_002), range(60_000, 60_008)),
    ("FrozenLake8x8-v1", "solved"): (range(20_000, 20_016), range(40_000, 40_200)),
    ("Taxi-v4", "solved"): (range(20_000, 20_100), range(50_000, 51_000)),
    ("qtab/Racetrack-v0", "solved"): (range(20_000, 20_010), range(40_000, 40_100)),
}
"""The seeds used to choose a preset, and the fresh seeds used to confirm it."""
OTHERS = (NO_SEEDS, range(40_000, 40_100))
"""The same for presets that were chosen without a search."""
GREEDY_SEEDS = 100
GREEDY_EPISODES = 1_000
Cells: TypeAlias = tuple[str, ...]

RESULTS: Cells = ("last 100", "worst seed", "solved", "solved at the end", "greedy", "threshold", "optimum")
SETTINGS: Cells = ("algorithm", "episodes", "search seeds", "their last 100", "fresh seeds")


def cells(env: str, preset: str) -> tuple[Cells, Cells]:
    """Trains a preset with its search seeds and with fresh ones, and returns its results and its settings."""
    threshold, optimum = gym.spec(env).reward_threshold, known_optimum(env)
    searched, fresh = SEEDS.get((env, preset), OTHERS)
    on_search_seeds = ""
    if searched:
        on_search_seeds = average(qtab.train_many(env, searched, preset=preset).final_returns(100))
    exact = optimum is not None and optimum.exact
    evaluated = fresh if exact else fresh[:GREEDY_SEEDS]
    kept = qtab.train_many(env, evaluated, preset=preset, tables=True)
    runs = kept if evaluated == fresh else qtab.train_many(env, fresh, preset=preset)  # without tables, which are large
    last = runs.final_returns(100)
    solved = ("", "")
    if threshold is not None:
        solved = tuple(map(share, (best_mean_returns(runs.episode_returns) >= threshold, last >= threshold)))
    results = (
        average(last),
        f"{last.min():.4g}",
        *solved,
        average(greedy_returns(kept, optimum)),
        "" if threshold is None else f"{threshold:g}",
        "" if optimum is None else f"{optimum.expected_return:.4g}" + ("" if optimum.exact else f" ({optimum.label})"),
    )
    settings = (
        runs.config.algorithm,
        f"{runs.config.episodes:,}",
        f"{len(searched):,}" if searched else "",
        on_search_seeds,
        f"{fresh[0]:,} to {fresh[-1]:,}",
    )
    return results, settings


def greedy_returns(runs: qtab.Runs, optimum: qtab.Optimum | None) -> ArrayLike:
    """Returns each greedy policy's expected return: exact if the transition table is known, else estimated."""
    if optimum is not None and optimum.exact:
        return optimum.gap(runs).greedy_return
    return [qtab.evaluate(run, GREEDY_EPISODES, seed=index).mean_return for index, run in enumerate(runs)]


def average(values: ArrayLike) -> str:
    """Formats the mean over seeds and its standard error."""
    error = np.std(values, ddof=1) / np.sqrt(np.size(values))
    return f"{np.mean(values):.4g}" + (f" ± {error:.1g}" if error > 1e-9 else "")


def share(passed: np.typing.NDArray[np.bool_]) -> str:
    """Formats how many of all seeds passed: "all", or their number."""
    return "all" if passed.all() else f"{np.count_nonzero(passed):,}"


def known_optimum(env: str) -> qtab.Optimum | None:
    """Returns the optimum, or the best known policy; None if neither is available."""
    try:
        return qtab.optimum(env)
    except ValueError:
        return None


def print_head(columns: Cells) -> None:
    """Prints the head of a table in Markdown."""
    print_row("environment", "preset", *columns)
    print("|---" * (2 + len(columns)) + "|")


def print_row(*row: str) -> None:
    """Prints a row in Markdown."""
    print("| " + " | ".join(row) + " |", flush=True)


def main() -> None:
    """Prints the tables, or the rows of one preset."""
    parser = argparse.ArgumentParser()
    parser.add_argument("env", nargs="?")
    parser.add_argument("preset", nargs="?", default="solved")
    asked = parser.parse_args()
    pairs = [(env, preset) for env in ENVIRONMENTS for preset in qtab.presets(env)]
    print_head(RESULTS)
    settings = {}
    for env, preset in pairs if asked.env is None else [(asked.env, asked.preset)]:
        results, settings[env, preset] = cells(env, preset)
        print_row(env, preset, *results)
    print()
    print_head(SETTINGS)
    for (env, preset), found in settings.items():
        print_row(env, preset, *found)


if __name__ == "__main__":  # worker processes import this file if Python steps the environment
    main()

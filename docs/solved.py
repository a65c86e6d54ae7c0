"""Prints the table of docs/environments.md: the results of every preset over 100 seeds. It takes a minute or two."""

import gymnasium as gym
import numpy as np

import qtab
from qtab.envs.registry import ENTRIES

SEEDS = 100
GREEDY_EPISODES = 1_000

COLUMNS = ("environment", "preset", "algorithm", "episodes", "last 100", "seeds solved")
COLUMNS += ("greedy", "threshold", "optimum")


def row(env: str, preset: str, optimum: qtab.Optimum | None) -> str:
    """Trains a preset with every seed and returns its row of the table."""
    runs = qtab.train_many(env, SEEDS, preset=preset, tables=True)
    threshold = gym.spec(env).reward_threshold
    cells = (
        env,
        preset,
        runs.config.algorithm,
        f"{runs.config.episodes:,}",
        average(runs.final_returns(100)),
        "" if threshold is None else str(np.count_nonzero(best_hundreds(runs) >= threshold)),
        average(greedy_returns(runs, optimum)),
        "" if threshold is None else f"{threshold:g}",
        "" if optimum is None else f"{optimum.expected_return:.4g}" + ("" if optimum.exact else f" ({optimum.label})"),
    )
    return "| " + " | ".join(cells) + " |"


def best_hundreds(runs: qtab.Runs) -> np.typing.NDArray[np.float64]:
    """Returns each run's best mean return over 100 consecutive episodes."""
    sums = np.cumsum(np.pad(runs.episode_returns, ((0, 0), (1, 0))), axis=1)
    return np.max((sums[:, 100:] - sums[:, :-100]) / 100, axis=1)


def greedy_returns(runs: qtab.Runs, optimum: qtab.Optimum | None) -> np.typing.ArrayLike:
    """Returns each greedy policy's expected return: exact if the transition table is known, else estimated."""
    if optimum is not None and optimum.exact:
        return optimum.gap(runs).greedy_return
    played = (qtab.evaluate(run, GREEDY_EPISODES, seed=index) for index, run in enumerate(runs))
    return [evaluation.mean_return for evaluation in played]


def average(values: np.typing.ArrayLike) -> str:
    """Formats the mean over seeds and its standard error."""
    error = np.std(values, ddof=1) / np.sqrt(SEEDS)
    return f"{np.mean(values):.4g}" + (f" ± {error:.1g}" if error > 1e-9 else "")


def known_optimum(env: str) -> qtab.Optimum | None:
    """Returns the optimum, or the best known policy; None if neither is available."""
    try:
        return qtab.optimum(env)
    except ValueError:
        return None


print("| " + " | ".join(COLUMNS) + " |")
print("|---" * len(COLUMNS) + "|")
for env in ENTRIES:
    if presets := qtab.presets(env):
        optimum = known_optimum(env)
        for preset in presets:
            print(row(env, preset, optimum), flush=True)

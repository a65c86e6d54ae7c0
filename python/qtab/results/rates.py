"""The rates in each episode of a run, even if it was resumed with more episodes and a falling rate."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.schedules import ByVisits, Constant, Linear, Schedule, epsilon, learning_rate
from qtab.results.run import Run

POINTS = 1000
"""The maximum number of evenly spaced episodes for which a rate is computed."""
ONLY_FIRST = "only those can be repeated, because its falling rates were then spread over more episodes"
"""The reason why the later episodes of an extended run cannot be repeated, for messages."""


def rates(schedule: Schedule, total: int, count: int) -> NDArray[np.float64]:
    """Returns (count,): the values of a schedule in the first episodes of a run, bit for bit those of the learners.

    Args:
        schedule: The schedule.
        total: The number of episodes of the run, over which a linear fall is spread.
        count: The number of first episodes. A run that is stopped early may need far fewer than ``total``.
    """
    values = np.full(count, schedule.value)
    if isinstance(schedule, Constant):
        return values
    falling = values[schedule.warm_up :]
    # Like the learners, subtract an amount or apply a factor after each episode in turn.
    if isinstance(schedule, Linear):
        falling[1:] = (schedule.value - schedule.minimum) / (total - schedule.warm_up)
        np.subtract.accumulate(falling, out=falling)
    else:
        falling[1:] = schedule.decay
        np.multiply.accumulate(falling, out=falling)
        np.maximum(falling, schedule.minimum, out=falling)
    at_least = falling <= schedule.minimum
    if at_least.any():
        first = int(np.argmax(at_least))
        falling[first:] = falling[first]
    return values


def rates_of(run: Run, schedule: Schedule, episodes: NDArray[np.int64]) -> NDArray[np.float64]:
    """Returns (n,): the values of a schedule of the run's config in n episodes, numbered from 0.

    Each extension spreads a linear fall over the new number of episodes, from the first episode on.
    """
    count = int(episodes.max(initial=-1)) + 1
    found: NDArray[np.float64] = rates(schedule, run.config.episodes, count)[episodes]
    for finished, total in reversed(() if run.state is None else run.state.extensions):
        early = episodes < finished
        found[early] = rates(schedule, total, finished)[episodes[early]]
    return found


def learning_rates(run: Run) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Returns (n,) evenly spaced episodes, including the last, and their (n,) learning rates; by visits, the first."""
    points, rate = _evenly_spaced(len(run.episode_returns)), learning_rate(run.config)
    if isinstance(rate, ByVisits):
        return points, np.full(len(points), rate.value)
    return points, rates_of(run, rate, points)


def epsilons(run: Run) -> NDArray[np.float64]:
    """Returns (n,): the rates of ε-greedy exploration in evenly spaced episodes, including the last."""
    return rates_of(run, epsilon(run.config), _evenly_spaced(len(run.episode_returns)))


def _evenly_spaced(episodes: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(0, episodes - 1, min(episodes, POINTS)).astype(np.int64))


def falling_rates(config: Config) -> list[str]:
    """Returns the names of the rates that fall linearly, and so depend on the total number of episodes."""
    falling = []
    for rate in ("epsilon", "learning_rate"):
        value, least = getattr(config, rate), getattr(config, f"min_{rate}")
        if getattr(config, f"{rate}_schedule") == "linear" and value != least:
            falling.append(rate)
    return falling


def extensions(run: Run, config: Config) -> tuple[tuple[int, int], ...]:
    """Returns the extensions of a run after it is resumed.

    Args:
        run: The earlier part.
        config: The config of the whole run.
    """
    earlier = () if run.state is None else run.state.extensions
    finished, episodes = len(run.episode_returns), run.config.episodes
    if finished == 0 or episodes == config.episodes or not falling_rates(config):
        return earlier  # the rates of the finished episodes do not change
    return (*earlier, (finished, episodes))


def repeatable(run: Run) -> tuple[Run, int]:
    """Returns a run with the config of its first episodes, and the number of these episodes.

    Training this config again repeats these episodes. They are all episodes, unless the run was extended with a
    falling rate, which depends on the number of episodes that the run had at the time.
    """
    if run.state is None or not run.state.extensions:
        return run, len(run.episode_returns)
    finished, episodes = run.state.extensions[0]
    return replace(run, config=run.config.replace(episodes=episodes)), finished

"""Runs that were resumed with more episodes, over which their falling rates were spread again."""

from dataclasses import replace

from qtab.config import Config
from qtab.results.run import Run

_RATES = ("epsilon", "learning_rate")
ONLY_FIRST = "only those can be repeated, because its falling rates were then spread over more episodes"
"""Why the later episodes of a run that was extended cannot be repeated, for messages."""


def falling_rates(config: Config) -> list[str]:
    """Returns the rates that fall linearly, so that each episode's depends on the number of all episodes."""
    falling = []
    for rate in _RATES:
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
        return earlier  # every episode has had the rates of the new number of episodes
    return (*earlier, (finished, episodes))


def repeatable(run: Run) -> tuple[Run, int]:
    """Returns a run with the config that its first episodes were trained with, and how many they are.

    Training this config again repeats these episodes. They are all of them, unless the run was extended while a rate
    fell: an episode's rate depends on the number of episodes that the run had at the time.
    """
    if run.state is None or not run.state.extensions:
        return run, len(run.episode_returns)
    finished, episodes = run.state.extensions[0]
    return replace(run, config=run.config.replace(episodes=episodes)), finished

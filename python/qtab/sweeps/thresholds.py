"""The threshold at which the environment of a sweep is solved."""

from qtab.envs.goals import reward_threshold
from qtab.sweeps.results import Sweep


def sweep_threshold(sweep: Sweep, setting: int | None = None) -> float | None:
    """Returns the threshold of a setting; None where none holds.

    Args:
        sweep: The sweep.
        setting: The index of the setting; None means all, which must then have the same threshold.
    """
    configs = sweep.configs if setting is None else sweep.configs[setting : setting + 1]
    found = {reward_threshold(config["env"], config["env_kwargs"], config["max_episode_steps"]) for config in configs}
    return found.pop() if len(found) == 1 else None

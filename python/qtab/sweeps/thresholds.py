"""The threshold at which the environment of a sweep is solved."""

from collections.abc import Mapping
from typing import Any

from qtab.envs.goals import reward_threshold
from qtab.envs.origin import EnvironmentDescription
from qtab.envs.origin.values import with_types
from qtab.sweeps.results import Sweep

Environment = tuple[str, Mapping[str, Any], int, EnvironmentDescription | None]
"""The id, the keyword arguments and the time limit of settings, and their environment in detail, if it is known."""


def sweep_threshold(sweep: Sweep, setting: int | None = None) -> float | None:
    """Returns the threshold of a setting; None where none holds; see :func:`qtab.envs.goals.reward_threshold`.

    Args:
        sweep: The sweep.
        setting: The index of the setting; None means all, which must then have the same threshold.
    """
    found = {reward_threshold(*environment) for environment in environments(sweep, setting)}
    return found.pop() if len(found) == 1 else None


def environments(sweep: Sweep, setting: int | None = None) -> list[Environment]:
    """Returns the different environments of a setting, or of all; none for a sweep without configs."""
    found: dict[str, Environment] = {}
    for index, config in enumerate(sweep.configs):
        if setting is None or index == setting:
            description = sweep._environments.get(index)
            given = config["env_kwargs"]
            kwargs = given if description is None else with_types(given, description.kwargs)
            environment = (config["env"], kwargs, config["max_episode_steps"], description)
            found.setdefault(repr(environment), environment)
    return list(found.values())

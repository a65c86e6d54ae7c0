"""The settings that change automatically when other settings of a config are changed."""

from collections.abc import Mapping
from typing import Any

import gymnasium as gym

from qtab.config.options import fixed_settings, freed_settings
from qtab.config.origin import Origin


def with_followers(
    config: Any, changes: Mapping[str, Any], defaults: Mapping[str, Any]
) -> tuple[dict[str, Any], Origin | None]:
    """Returns the changes to a config together with those that follow from them, and the new origin.

    Args:
        config: The config.
        changes: The settings that are changed.
        defaults: The default of each setting.
    """
    own: dict[str, Any] = {}
    origin: Origin | None = config.origin
    if origin is not None and changes.get("env", config.env) != config.env:
        spec = gym.registry.get(config.env.rpartition(":")[2])
        registered = {} if spec is None else spec.kwargs
        kwargs = config.env_kwargs.items()
        own |= {name: defaults[name] for name in (*origin.derived, "preset")}
        own["env_kwargs"] = {
            name: value for name, value in kwargs if name not in registered or registered[name] != value
        }
        origin = None
    algorithm = changes.get("algorithm", config.algorithm)
    own |= {name: defaults[name] for name in freed_settings(config.algorithm, algorithm)}
    if changes.get("time_aware", config.time_aware):
        own["on_truncation"] = "terminate"
    elif config.time_aware:
        own["on_truncation"] = defaults["on_truncation"]
    own |= fixed_settings(algorithm)
    return {**own, **changes}, None if origin is None else origin.without(changes)

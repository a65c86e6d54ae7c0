"""The page's data on environments and settings, made from the package's own definitions."""

from collections.abc import Mapping
from dataclasses import asdict
from functools import cache
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils.versions import versions
from qtab.config.options import n_tables
from qtab.config.preset_settings import CLIFF_WALKING
from qtab.config.presets import presets
from qtab.envs.grid_worlds import ACTION_NAMES
from qtab.envs.metadata.quantities import Quantities, quantities_of
from qtab.explanation.equations import bootstrap_symbol
from qtab.playground.environments import ENVIRONMENTS, Entry
from qtab.playground.settings import LEFT_OUT, MAX_FEATURES, OFFERED, implied, rules, settings

GRID_TIME_LIMIT = 1000
"""The time limit of grid worlds, in steps."""


@cache
def definitions() -> dict[str, Any]:
    """Returns the page's data on environments and settings, ready for JSON."""
    return {
        "version": versions()["qtab"],
        "environments": {key: _environment(key, entry) for key, entry in ENVIRONMENTS.items()},
        "settings": _plain(settings()),
        "rules": rules(),
        "implied": implied(),
        "max_features": MAX_FEATURES,
        "bootstraps": {
            name: [bootstrap_symbol(name, table) for table in range(n_tables(name))] for name in OFFERED["algorithm"]
        },
    }


def _environment(key: str, entry: Entry) -> dict[str, Any]:
    return {
        "id": key,
        "title": entry.title,
        "sentence": entry.sentence,
        "drawing": entry.drawing,
        "python": entry.env or None,
        "env_kwargs": dict(entry.env_kwargs),
        "best_known": entry.best_known,
        "chaotic": entry.chaotic,
        "grids": {name: _plain(asdict(grid)) for name, grid in entry.grids.items()},
        # Those of an environment whose observations are the numbers of its states.
        "observations": None,
        "map": None,
        "discretizers": ["identity"],
        "options": {},
        # None is unknown.
        "states": None,
        "layout": None,
        "threshold": None,
        **(_grid_world(entry) if entry.grids else _gymnasium(entry)),
    }


def _grid_world(entry: Entry) -> dict[str, Any]:
    grid = next(iter(entry.grids.values()))
    return {
        "actions": list(ACTION_NAMES),
        "states": len(grid.layout) * len(grid.layout[0]),
        "layout": list(grid.layout),
        "max_episode_steps": GRID_TIME_LIMIT,
        "presets": {"learns": {**CLIFF_WALKING, "discretizer": "identity"}},
    }


def _gymnasium(entry: Entry) -> dict[str, Any]:
    env = gym.make(entry.env, **entry.env_kwargs)
    spec, unwrapped = env.spec, env.unwrapped
    assert spec is not None  # noqa: S101 - made by its id
    description = quantities_of(entry.env)
    space: Any = env.observation_space
    tabular = isinstance(space, gym.spaces.Discrete)
    numbered = tabular or isinstance(space, gym.spaces.Tuple)
    given = {
        name: {setting: value for setting, value in preset.items() if setting not in LEFT_OUT}
        for name, preset in (entry.presets or presets(entry.env)).items()
        if not preset.get("time_aware")  # the page cannot show the additional axis of its table
    }
    made = {
        "actions": list(description.actions),
        "max_episode_steps": spec.max_episode_steps or GRID_TIME_LIMIT,
        "threshold": spec.reward_threshold,
        "presets": {
            name: _plain({"discretizer": "identity" if numbered else "round", **preset})
            for name, preset in given.items()
        },
    }
    env.close()
    if entry.layout:
        parts = [space] if tabular else space
        return {**made, "states": int(np.prod([part.n for part in parts])), "layout": [*entry.layout]}
    if tabular:
        return {**made, "states": int(space.n), "layout": _layout(unwrapped)}
    low, high = space.low, space.high
    bounded = bool(np.isfinite([low, high]).all()) and bool((np.abs([low, high]) < 1e6).all())
    options = _options(given, low.tolist(), high.tolist(), bounded)
    plane = description.plane or [quantity.name for quantity in description.observation[:2]]
    return made | {
        "observations": [
            {"name": quantity.name, "unit": quantity.unit or None, "low": _finite(lower), "high": _finite(upper)}
            for quantity, lower, upper in zip(description.observation, low.tolist(), high.tolist(), strict=True)
        ],
        # Rounding needs a scale for the observations.
        "discretizers": [*(["round"] if "scale" in options else []), "bins", "tiles", "fourier"],
        "options": options,
        "map": {axis: _axis(description, name) for axis, name in zip("xy", plane, strict=True)},
    }


def _axis(description: Quantities, name: str) -> dict[str, Any]:
    """An axis of the map of values: a component of the observations, or an angle by the component of its cosine."""
    angles = {angle.quantity.name: angle for angle in description.angles}
    if name in angles:
        quantity, component = angles[name].quantity, angles[name].cosine
    else:
        component = [quantity.name for quantity in description.observation].index(name)
        quantity = description.observation[component]
    return {"name": name, "unit": quantity.unit or None, "component": component, "is_angle": name in angles}


def _options(given: Mapping[str, Mapping[str, Any]], low: Any, high: Any, bounded: bool) -> dict[str, Any]:
    """The defaults of the options that depend on the observations: from the presets or the observation space."""
    found: dict[str, Any] = {"low": low, "high": high} if bounded else {}
    for preset in given.values():
        for name in ("scale", "low", "high"):
            if name in preset and name not in found:
                found[name] = _plain(preset[name])
    return found


def _layout(env: Any) -> list[str]:
    """The map of a lake or a cliff, one letter per cell: start, goal, frozen, hole, cliff."""
    if hasattr(env, "desc"):
        return ["".join(letter.decode() for letter in row) for row in env.desc.tolist()]
    rows, columns = env.shape
    letters = np.where(env._cliff, "C", ".")
    letters[np.unravel_index(env.start_state_index, env.shape)] = "S"
    letters[rows - 1, columns - 1] = "G"
    return ["".join(row) for row in letters.tolist()]


def _finite(value: float) -> float | None:
    return value if abs(value) < 1e6 else None


def _plain(value: Any) -> Any:
    """Returns a value in the types of JSON: tuples become lists."""
    if isinstance(value, Mapping):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(part) for part in value]
    return value

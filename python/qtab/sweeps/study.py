"""The study of a sweep, complete before it starts: its settings and seeds, and their JSON form in a store."""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from qtab._utils import checks
from qtab._utils.memory import check_memory
from qtab._utils.shown import counted
from qtab.config import DEFAULTS
from qtab.config.functions import function_name
from qtab.config.merge import Base, over
from qtab.config.unknown import check_names
from qtab.envs.origin.description import EnvironmentDescription
from qtab.envs.registry import stored_id
from qtab.results.files.file_parts import corrected_settings, stored_settings
from qtab.sweeps import designs
from qtab.training.setup.resolved_run import ResolvedRun
from qtab.training.setup.run_env import environment_of
from qtab.training.setup.run_memory import bytes_of_run
from qtab.training.train_many import resolve_template, seed_numbers

BYTES_PER_STORED_RUN = 1000
"""The approximate size in memory of the results and the seed of a stored run."""
BYTES_PER_SETTING = 4000
"""The approximate size of a setting and its config in memory."""

_STUDY_TYPES = {"configs": list, "settings": list, "seeds": list, "block": int}


@dataclass(frozen=True)
class StoredStudy:
    """A study in a store. Run ``i`` has setting ``i // len(seeds)`` and seed ``seeds[i % len(seeds)]``."""

    configs: Sequence[Mapping[str, Any]]
    """The config of each setting, without the seed, as JSON represents it; no text in it selects a module to import."""
    settings: Sequence[Mapping[str, Any]]
    """The values that the grid gives to each setting."""
    seeds: tuple[int, ...]
    """The seeds of every setting."""
    block: int
    """The number of episodes that each point of a learning curve averages."""
    environments: str | None = None
    """The environments in detail, as JSON text; None if a store does not hold them."""

    @property
    def runs(self) -> int:
        """The number of runs."""
        return len(self.settings) * len(self.seeds)

    @property
    def text(self) -> str:
        """The study as JSON text, which is equal only for equal studies. It is part of the store format."""
        return json.dumps({name: getattr(self, name) for name in _STUDY_TYPES}, sort_keys=True)

    def has_more_seeds(self, other: "StoredStudy") -> bool:
        """Returns whether this study is ``other`` with additional seeds."""
        is_same = replace(self, seeds=()).text == replace(other, seeds=()).text
        return is_same and set(self.seeds) > set(other.seeds)


@dataclass(frozen=True)
class Study:
    """All runs of a sweep planned in this process, numbered as in :class:`StoredStudy`."""

    env: Any
    settings: Sequence[Mapping[str, Any]]
    """The points of the grid: the config fields in which the settings differ."""
    overrides: Sequence[Mapping[str, Any]]
    """The config fields given for each setting, including those shared by all settings."""
    seeds: tuple[int, ...]
    """The seeds of every setting."""
    resolved: Sequence[ResolvedRun]
    """The resolved config of each setting."""
    block: int
    """The number of episodes that each point of a learning curve averages."""
    memory_limit: int | None = None
    """The most memory that a single run may take, in bytes; None means half of the memory of its machine."""

    @property
    def runs(self) -> int:
        """The number of runs."""
        return len(self.settings) * len(self.seeds)

    @property
    def environments(self) -> dict[int, EnvironmentDescription]:
        """The environment of each setting, by the index of the setting."""
        return {setting: environment_of(resolved) for setting, resolved in enumerate(self.resolved)}

    def check_memory(self) -> None:
        """Checks that a single run of each setting fits into the memory limit.

        Raises:
            MemoryError: if it does not; the message states the memory needed.
        """
        for resolved in self.resolved:
            what = f"runs of {counted(resolved.config.episodes, 'episode')}"
            check_memory(what, bytes_of_run(resolved), self.memory_limit)

    @cached_property
    def stored(self) -> StoredStudy:
        """The study in the form of a store."""
        configs = [
            {name: value for name, value in stored_settings(resolved.config).items() if name != "seed"}
            for resolved in self.resolved
        ]
        settings = [dict(setting) for setting in self.settings]
        content = {"configs": configs, "settings": settings, "seeds": self.seeds, "block": self.block}
        return study_from_json(json.dumps(content, default=_jsonable))

    def split(self, chunk: range) -> list[tuple[int, list[int]]]:
        """Returns the indices of the settings of consecutive runs, each with its seeds."""
        count = len(self.seeds)
        parts = []
        for setting in range(chunk.start // count, (chunk.stop - 1) // count + 1):
            first, last = max(chunk.start - setting * count, 0), min(chunk.stop - setting * count, count)
            parts.append((setting, list(self.seeds[first:last])))
        return parts


def study_from_json(text: str) -> StoredStudy:
    """Returns the study that JSON text describes.

    Raises:
        ValueError: if ``text`` does not describe a study; the message gives the reason.
    """
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"its study is not JSON: {error}") from None
    if not isinstance(content, dict) or not all(type(content.get(name)) is kind for name, kind in _STUDY_TYPES.items()):
        raise ValueError("its study has no configs, settings, seeds and block")
    configs, settings, seeds, block = (content[name] for name in _STUDY_TYPES)
    if not settings or len(configs) != len(settings) or block < 1:
        raise ValueError("its study must have one config for each setting and a positive block")
    if not seeds or not all(type(seed) is int and seed >= 0 for seed in seeds) or len(set(seeds)) < len(seeds):
        raise ValueError("its study has bad seeds")
    for config, setting in zip(configs, settings, strict=True):
        if not isinstance(setting, dict) or not setting or setting.keys() != settings[0].keys():
            raise ValueError("the settings of its study do not have the same names")
        if not isinstance(config, dict) or not isinstance(config.get("env"), str):
            raise ValueError("a config of its study has no env")
        for name in ("episodes", "max_episode_steps"):
            if type(config.get(name)) is not int or config[name] < 1:
                raise ValueError(f"a config of its study has bad {name}")
    configs = [{**corrected_settings(config), "env": stored_id(config["env"])} for config in configs]
    return StoredStudy(configs, settings, tuple(seeds), block)


def plan_study(
    env: Any,
    grid: Any,
    seeds: Any,
    block: int,
    shared: Mapping[str, Any],
    base: Base | None = None,
    memory_limit: int | None = None,
) -> Study:
    """Returns the study of a grid of settings, after resolving the config of each.

    Raises:
        MemoryError: if the settings and the results need more than ``memory_limit`` bytes (None: half of the
            machine's memory).
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        TypeError: for an argument of the wrong type, or an unknown setting.
        ValueError: for an argument out of range.
    """
    settings = settings_of(grid, memory_limit)
    _check_runs(len(settings), seeds, memory_limit)
    numbers = seed_numbers(seeds)
    names = list(settings[0])
    check_names({**shared, **settings[0]}, DEFAULTS)
    for name, argument in (("seed", "seeds"), ("env", "env")):
        if name in names or name in shared:
            raise TypeError(f"{name} cannot be a setting of a sweep; use the argument {argument}")
    in_both = sorted(set(names) & set(shared))
    if in_both:
        raise TypeError(f"{in_both[0]} must be either in the grid or shared by all settings, got both")
    overrides = [over(base or {}, {**shared, **setting}) for setting in settings]
    resolved = [resolve_template(env, {**given, "seed": max(numbers)}) for given in overrides]
    for setting, run in zip(settings, resolved, strict=True):
        asked = setting.get("max_episode_steps")
        if asked is not None and asked > run.max_episode_steps:
            raise ValueError(
                f"max_episode_steps must be at most {run.max_episode_steps} in the grid, the time limit of the "
                f"environment, got {asked}"
            )
    return Study(env, settings, overrides, numbers, resolved, block)


def _check_runs(settings: int, seeds: Any, limit: int | None) -> None:
    """Checks that the results fit into memory, before making a list of the seeds."""
    is_number = hasattr(seeds, "__index__") and not np.ndim(seeds)
    if is_number:
        count = checks.integer("seeds", seeds, least=1)
    elif isinstance(seeds, range):  # it can be longer than len() supports
        count = (seeds.stop - seeds.start) // seeds.step
    else:
        count = len(seeds) if hasattr(seeds, "__len__") else 1
    runs = settings * count
    check_memory(f"the results of {counted(runs, 'run')}", runs * BYTES_PER_STORED_RUN, limit)


def settings_of(grid: Any, limit: int | None = None) -> list[dict[str, Any]]:
    """Returns the settings of a grid, all of which have the same names in the same order.

    Raises:
        MemoryError: if the settings need more than ``limit`` bytes; None means half of the machine's memory.
        TypeError: if ``grid`` is neither a mapping nor a list of mappings.
        ValueError: if ``grid`` has no settings, the same one twice, or settings with different names.
    """
    if isinstance(grid, Mapping):
        count = math.prod(len(values) for values in grid.values() if hasattr(values, "__len__"))
        check_memory(counted(count, "setting"), count * BYTES_PER_SETTING, limit)
        return designs.grid(grid)
    if isinstance(grid, (str, bytes)) or not isinstance(grid, Sequence):
        raise TypeError(f"grid must map names to lists of values, or be a list of mappings, got {grid!r}")
    if not grid:
        raise ValueError("grid must hold at least one setting, got none")
    for setting in grid:
        if not isinstance(setting, Mapping):
            raise TypeError(f"grid must hold mappings of names to values, got {setting!r}")
    if len({json.dumps(dict(setting), sort_keys=True, default=_jsonable) for setting in grid}) < len(grid):
        raise ValueError("grid must hold different settings, got the same one twice")
    names = list(grid[0])
    for index, setting in enumerate(grid):
        missing = [name for name in names if name not in setting]
        more = [name for name in setting if name not in grid[0]]
        if missing or more:
            lacks = f"lacks {_quoted(missing)}" if missing else ""
            adds = f"also has {_quoted(more)}" if more else ""
            differs = " and ".join(filter(None, (lacks, adds)))
            raise ValueError(f"every setting in grid must have the names of the first, but grid[{index}] {differs}")
    return [{name: setting[name] for name in names} for setting in grid]


def _quoted(names: Sequence[Any]) -> str:
    return ", ".join(map(repr, names))


def _jsonable(value: Any) -> Any:
    """Converts a value that JSON cannot represent into one that it can. This is part of the store format."""
    if isinstance(value, np.ndarray):
        return {"shape": value.shape, "sha256": hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return dict(value)
    return {"function": function_name(value)} if callable(value) else repr(value)


def to_cell(value: Any) -> Any:
    """Returns the value of a setting as a number, string, boolean or None, for a column of a table."""
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else repr(value)
    return json.dumps(value, default=_jsonable)

"""The study file of ``qtab sweep``: a TOML file that describes a sweep."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from qtab._utils.shown import did_you_mean
from qtab.cli.toml_file import read_toml
from qtab.config import DEFAULTS
from qtab.config.unknown import check_names
from qtab.sweeps import designs

KEYS = ("env", "seeds", "block", "store", "threads", "memory_limit", "grid", "design", "config")
_DESIGN_KEYS = ("kind", "points", "seed", "space")
_AXIS_KEYS = ("low", "high", "log")
_DESIGNS = {"random": designs.random, "sobol": designs.sobol}


@dataclass(frozen=True)
class StudyFile:
    """The content of a study file."""

    env: str
    """The environment's id."""
    grid: Any
    """The settings, as :func:`qtab.sweep` takes them."""
    store: str | None
    """The file for the results, relative to the folder of the study file."""
    config: Mapping[str, Any]
    """The settings that all runs share."""
    options: Mapping[str, Any]
    """The other arguments of :func:`qtab.sweep` that the file gives."""


def read_study(path: Path) -> StudyFile:
    """Returns the content of a study file. The values of settings are checked later, by :func:`qtab.sweep`.

    Raises:
        UsageError: if the file cannot be read.
        ValueError: if it is not TOML, or does not describe a sweep; the message names the file and the key.
    """
    content = read_toml("STUDY", path)
    try:
        return _study(content)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: {error}") from None


def _study(content: Mapping[str, Any]) -> StudyFile:
    _check_keys(content, KEYS)
    if ("grid" in content) == ("design" in content):
        raise ValueError("a study must have either a [grid] or a [design]")
    grid = _grid(content["grid"]) if "grid" in content else _design(content["design"])
    if "env" not in content:
        raise ValueError('env is missing: add a line such as env = "MountainCar-v0" before the first [table]')
    config = _table("config", content.get("config", {}))
    for key in config:
        if key in KEYS:
            raise ValueError(f"{key} must be before the first [table], not in [config]")
    check_names(config, [name for name in DEFAULTS if name != "env"])
    return StudyFile(
        env=_text("env", content["env"]),
        grid=grid,
        store=_text("store", content["store"]) if "store" in content else None,
        config={name: _tuple(value) for name, value in config.items()},
        options={key: content[key] for key in ("seeds", "block", "threads", "memory_limit") if key in content},
    )


def _grid(grid: Any) -> Any:
    return {
        name: [_tuple(value) for value in values] if isinstance(values, list) else values
        for name, values in _table("grid", grid).items()
    }


def _design(design: Any) -> list[dict[str, Any]]:
    table = _table("design", design)
    _check_keys(table, _DESIGN_KEYS, " in [design]")
    kind = table.get("kind", "sobol")
    if kind not in list(_DESIGNS) or "points" not in table or "space" not in table:
        raise ValueError("[design] must have kind = 'random' or 'sobol', points, space and optionally seed")
    space = {name: _axis(name, axis) for name, axis in _table("design.space", table["space"]).items()}
    return _DESIGNS[kind](space, table["points"], table.get("seed", 0))


def _axis(name: str, axis: Any) -> Any:
    """Returns an axis of a design from ``{low = 0.01, high = 1.0, log = true}`` or a list of choices."""
    if isinstance(axis, list):
        return [_tuple(value) for value in axis]
    if not isinstance(axis, dict) or not axis.keys() <= set(_AXIS_KEYS) or not {"low", "high"} <= axis.keys():
        raise ValueError(
            f"design.space.{name} must be a list of choices or {{low = ..., high = ..., log = true or false}}, "
            f"got {axis!r:.100}"
        )
    if not isinstance(axis.get("log", False), bool):
        raise ValueError(f"design.space.{name}.log must be true or false, got {axis['log']!r:.100}")
    bounds = (axis["low"], axis["high"])
    return (*bounds, "log") if axis.get("log") else bounds


def _check_keys(table: Mapping[str, Any], known: Sequence[str], where: str = "") -> None:
    for key in table:
        if key not in known:
            raise ValueError(f"unknown key {key!r}{where}{did_you_mean(key, known)}; use {', '.join(known)}")


def _table(key: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise ValueError(f"{key} must be a table, [{key}], got {value!r:.100}")
    return value


def _text(key: str, value: Any) -> str:
    if not isinstance(value, str) or not value:
        raise ValueError(f"{key} must be a string, got {value!r:.100}")
    return value


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value

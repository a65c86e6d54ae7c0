"""Every field of the config as a flag, its default what the environment's preset and the ``--config`` file make it."""

import ast
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from qtab.config import Config, known_fields
from qtab.config.presets import preset
from qtab.discretizers.tile_coding import Tiling
from qtab.envs.registry import spec_of, versioned
from qtab.results.storage import load
from qtab.training.resolve import merge

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


def _value(text: str) -> Any:
    for read in (json.loads, ast.literal_eval):
        try:
            return read(text)
        except (ValueError, SyntaxError):
            pass
    return text


def _pairs(words: list[str]) -> dict[str, Any]:
    if len(words) % 2:
        raise ValueError(f"{words[-1]!r} has no value")
    return {key: _value(text) for key, text in zip(words[::2], words[1::2], strict=True)}


PAIRS = tyro.constructors.PrimitiveConstructorSpec[Mapping[str, Any]](
    nargs="*",
    metavar="[KEY VALUE ...]",
    instance_from_str=_pairs,
    is_instance=lambda value: isinstance(value, Mapping),
    str_from_instance=lambda value: [word for key, item in value.items() for word in (key, json.dumps(item))],
)


def _first_values(words: list[str]) -> tuple[float, float] | float | Path:
    if len(words) == 1:
        try:
            return float(words[0])
        except ValueError:
            return Path(words[0])
    if len(words) != 2:
        raise ValueError(f"it takes LOW HIGH, VALUE or FILE, got {' '.join(words)!r}")
    return float(words[0]), float(words[1])


_FIRST_VALUES = tyro.constructors.PrimitiveConstructorSpec[tuple[float, float] | float | Path](
    nargs="*",
    metavar="LOW HIGH|VALUE|FILE",
    instance_from_str=_first_values,
    is_instance=lambda value: isinstance(value, tuple | float | Path),
    str_from_instance=lambda value: list(map(str, value)) if isinstance(value, tuple) else [str(value)],
)


def _words(value: Any) -> list[str]:
    if value is None:
        return ["None"]
    return [json.dumps(part) for part in (value if isinstance(value, tuple | list) else (value,))]


def _edge_rows(words: list[str]) -> Any:
    rows = [_value(word) for word in words]
    if rows == [None]:
        return None
    if not all(isinstance(row, list) for row in rows):
        raise ValueError(f"it takes a row such as [-0.5,0,0.5] for each component, got {' '.join(words)!r}")
    return tuple(rows)


_EDGES = tyro.constructors.PrimitiveConstructorSpec[Any](
    nargs="*",
    metavar="[NUMBER,...] ...",
    instance_from_str=_edge_rows,
    is_instance=lambda value: value is None or isinstance(value, tuple),
    str_from_instance=_words,
)


def _chosen_actions(words: list[str]) -> Any:
    values = [_value(word) for word in words]
    if values == [None]:
        return None
    if any(isinstance(value, str) for value in values):
        raise ValueError(f"it takes a count or the actions themselves, got {' '.join(words)!r}")
    return values[0] if len(values) == 1 and isinstance(values[0], int) else tuple(values)


_ACTIONS = tyro.constructors.PrimitiveConstructorSpec[Any](
    nargs="*",
    metavar="COUNT|ACTION ACTION ...",
    instance_from_str=_chosen_actions,
    is_instance=lambda value: value is None or isinstance(value, int | tuple),
    str_from_instance=_words,
)


@dataclass(frozen=True, eq=False)
class Settings(Config):
    """The config as it is typed; the checks wait until it is resolved."""

    env: tyro.conf.Positional[str] = Config.env
    """Gymnasium's id of the environment (--env ID does as well)."""
    env_kwargs: Annotated[Mapping[str, Any], PAIRS] = field(default_factory=dict)
    """Keyword arguments of the environment's constructor."""
    edges: Annotated[Any, _EDGES] = None
    """For each component of the observation the rising numbers between its bins, such as [-0.5,0,0.5] [0]."""
    actions: Annotated[Any, _ACTIONS] = None
    """What to choose from where the action space is a Box: how many equal steps from its low to its high, or the
    actions themselves, [X,Y] where they have several components."""
    initial_q: Annotated[Any, _FIRST_VALUES] = Config.initial_q
    """The first Q table: drawn uniformly from a range, one value everywhere, or a saved run to go on from."""

    def __post_init__(self) -> None:
        """Checks nothing yet: these may be the defaults of another environment."""

    def overrides(self) -> dict[str, Any]:
        """Returns all settings but the environment, for :func:`qtab.training.resolve.resolve`.

        Raises:
            OSError: if the run to go on from cannot be read.
            ValueError: if it is no run.
        """
        # What the preset says is left to it: it yields where it has no meaning beside what was asked for.
        _, start = preset(self.env, self.preset)
        values = {
            name: value
            for name, value in vars(self).items()
            if name != "env" and not (name in start and start[name] == value)
        }
        if isinstance(self.initial_q, Path):
            run = load(self.initial_q)
            values["initial_q"] = run.tables if isinstance(run.grid, Tiling) or len(run.tables) > 1 else run.q_table
        return values


def defaults(env: str | None, preset: str | None, config: Path | None) -> Settings:
    """Returns the settings before any flag: the environment's preset, the named one over it, the file over both.

    Args:
        env: The environment; None takes the file's, or the config's default.
        preset: The named preset; None takes the file's, or the environment's own.
        config: A TOML file of settings.

    Raises:
        gymnasium.error.Error: for an environment that Gymnasium does not know.
        OSError: if the file cannot be read.
        TypeError: for a mistyped setting.
        ValueError: for an unknown setting, or one out of range.
    """
    layer = {} if config is None else _read(config)
    named = layer.pop("env", Config.env)
    if not isinstance(named, str):
        raise TypeError(f"env must be an environment id, got {named!r}")
    env = versioned(env or named)
    start = layer.pop("initial_q", None)
    if start is not None and not isinstance(start, str):
        layer["initial_q"] = np.array(start) if np.ndim(start) > 1 else start
        start = None
    if preset is not None:
        layer["preset"] = preset
    merged = merge(env, {"env_kwargs": dict(spec_of(env).kwargs)}, layer)
    changes = {} if start is None else {"initial_q": Path(start)}
    return Settings(**{**vars(merged), **changes})


def _read(path: Path) -> dict[str, Any]:
    with path.open("rb") as file:
        try:
            layer = tomllib.load(file)
        except ValueError as error:
            raise ValueError(f"config must be a TOML file, got {str(path)!r}: {error}") from None
    try:
        known_fields(layer)
    except TypeError as error:
        raise ValueError(f"{path}: {error}") from None
    return layer


def last_value(arguments: Sequence[str], flag: str) -> str | None:
    """Returns what a flag is given, before the flags are parsed; None without it."""
    value = None
    for word, following in zip(arguments, [*arguments[1:], None], strict=True):
        if word == flag:
            value = following
        elif word.startswith(f"{flag}="):
            value = word.removeprefix(f"{flag}=")
    return value

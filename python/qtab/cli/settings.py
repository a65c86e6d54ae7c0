"""The settings of a run as flags, with the explanations of the API's docstrings, and as a TOML file."""

import sys
from collections.abc import Mapping
from dataclasses import field, make_dataclass
from functools import partial
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, get_args, get_type_hints

import numpy as np
import tyro

from qtab._utils.shown import shown
from qtab.cli import constructors
from qtab.cli.usage import reading
from qtab.config import DEFAULTS, Config
from qtab.config.choices import CHOICES
from qtab.config.explanations import applicability, explanations, groups
from qtab.config.unknown import check_names
from qtab.results.storage import load

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_BY_NAME: Mapping[str, Any] = {
    "env_kwargs": ("[KEY VALUE ...]", "*", constructors.read_pairs),
    "edges": ("[NUMBER,...] ...", "*", constructors.read_edges),
    "actions": ("COUNT|ACTION ACTION ...", "*", constructors.read_actions),
    "action_mask": ("{True,False}", 1, constructors.read_flag),
    "baseline": ("{True,False}", 1, constructors.read_flag),
    "time_aware": ("{True,False}", 1, constructors.read_flag),
    "initial_q": ("LOW HIGH|VALUE|FILE", "*", constructors.read_initial_q),
}
_BY_TYPE: Mapping[Any, Any] = {
    float: ("FLOAT", 1, constructors.read_float),
    int: ("INT", 1, constructors.read_int),
    str: ("STR", 1, constructors.read_str),
    tuple[float, ...]: ("[FLOAT ...]", "*", constructors.read_floats),
    tuple[int, ...]: ("[INT ...]", "*", constructors.read_ints),
}
"""What ``--help`` shows after the flag, how many words follow it, and how they are read."""
_EXPLANATIONS = {
    "edges": "The inner edges between the bins of each component of the observation, such as [-0.5,0,0.5] [0].",
    "actions": "The actions to choose from if the action space is a Box: the number of evenly spaced values along each "
    "component, or the actions themselves, [X,Y] if they have several components.",
    "action_mask": "Whether to take only the actions that the environment's masks leave: by its method action_masks(), "
    "or else in info['action_mask'].",
    "initial_q": "The initial Q table: drawn uniformly from a range, one number everywhere, or that of a saved run.",
}
"""The settings whose values look different on the command line."""


NOT_GIVEN = object()
"""What stands for a setting that is not given on the command line."""


def flag_groups(defaults: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the flags of each group of settings, by its title: a dataclass, whose defaults are ``NOT_GIVEN``.

    Args:
        defaults: The defaults that ``--help`` shows.
    """
    types = get_type_hints(Config)
    return {
        title: make_dataclass(
            title,
            [(name, _flag(name, types[name], defaults[name]), field(default=NOT_GIVEN)) for name in names],
        )
        for title, names in groups(DEFAULTS.keys() - {"env"}).items()
    }


def given_flags(group: Any) -> dict[str, Any]:
    """Returns the settings of a group of flags that are given on the command line."""
    return {name: value for name, value in vars(group).items() if value is not NOT_GIVEN}


def _flag(name: str, type_: Any, default: Any) -> Any:
    optional = NoneType in get_args(type_)
    if name in CHOICES:
        words = CHOICES[name]
        kind: Any = f"{{{','.join(words)}}}", 1, partial(constructors.read_choice, choices=words)
    else:
        kind = _BY_NAME.get(name) or _BY_TYPE[get_args(type_)[0] if optional else type_]
    argument = tyro.conf.arg(
        help=f"{_EXPLANATIONS.get(name, explanations().get(name, ''))} {applicability(name)}".strip(),
        prefix_name=False,
        help_behavior_hint=f"(default: {_shown(default)})",
    )
    # Of any type: tyro would check Any with typeguard, which takes 30 ms to load.
    return Annotated[object, constructors.constructor(*kind, optional=optional), argument]


def _shown(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}"
    return constructors.words_of(value) or "none"


def read_config(path: Path) -> dict[str, Any]:
    """Returns the settings in a TOML file.

    Raises:
        OSError: if the file cannot be read.
        ValueError: if it is not TOML, or holds an unknown setting.
    """
    with reading("--config", path), path.open("rb") as file:
        try:
            settings = tomllib.load(file)
        except ValueError as error:
            raise ValueError(f"--config must be a TOML file, got {shown(str(path))}: {error}") from None
        except RecursionError:
            raise ValueError(f"--config must be a TOML file, got {shown(str(path))}: it is nested too deeply") from None
    try:
        check_names(settings, DEFAULTS)
    except TypeError as error:
        raise ValueError(f"{path}: {error}") from None
    initial_q = settings.get("initial_q")
    if isinstance(initial_q, str):
        settings["initial_q"] = Path(initial_q)
    elif isinstance(initial_q, list) and any(isinstance(row, list) for row in initial_q):
        try:
            settings["initial_q"] = np.array(initial_q, np.float64)
        except (TypeError, ValueError):
            raise ValueError(f"{path}: initial_q must be a table of numbers, got {shown(initial_q)}") from None
    return settings


def with_initial_q(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings with the Q table of a saved run where ``initial_q`` is its file.

    Raises:
        OSError: if the file cannot be read.
        ValueError: if it is not a run.
    """
    path = settings.get("initial_q")
    if not isinstance(path, Path):
        return dict(settings)
    with reading("--initial-q", path):
        run = load(path)
    one_table_of_cells = run.discretizer.has_cells and len(run.tables) == 1
    return {**settings, "initial_q": run.q_table if one_table_of_cells else run.tables}

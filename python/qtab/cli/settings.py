"""The settings of a run as flags, with the explanations of the API's docstrings, and as a TOML file."""

from argparse import SUPPRESS, Namespace
from collections.abc import Callable, Mapping
from pathlib import Path
from types import NoneType
from typing import Any, get_args, get_type_hints

import numpy as np

from qtab._utils.shown import shown
from qtab.cli import values
from qtab.cli.errors import flag, reading
from qtab.cli.parser import Parser, Together
from qtab.cli.toml_file import read_toml
from qtab.config import DEFAULTS, Config
from qtab.config.choices import CHOICES
from qtab.config.help import applicability, explanations, groups
from qtab.config.unknown import check_names
from qtab.results.files.loading import load

_READERS: Mapping[Any, tuple[Callable[[Any], Any], str, bool]] = {
    "env_kwargs": (values.pairs, "KEY VALUE", True),
    "edges": (values.edges, "[NUMBER,...]", True),
    "actions": (values.actions, "COUNT|ACTION", True),
    "initial_q": (values.initial_q, "LOW HIGH|VALUE|FILE", True),
    "action_mask": (values.true_or_false, "{True,False}", False),
    bool: (values.true_or_false, "{True,False}", False),
    float: (values.number, "FLOAT", False),
    int: (values.integer, "INT", False),
    str: (str, "STR", False),
    tuple[float, ...]: (values.numbers, "FLOAT", True),
    tuple[int, ...]: (values.integers, "INT", True),
}
"""By the name or type of a setting: the reader of its words, their name in ``--help``, and whether it has several."""
_EXPLANATIONS = {
    "edges": "The inner edges between the bins of each component of the observation, such as [-0.5,0,0.5] [0].",
    "actions": "The actions to choose from if the action space is a Box: the number of evenly spaced values along each "
    "component, or the actions themselves, [X,Y] if they have several components.",
    "action_mask": "Whether to take only the actions that the environment's masks allow: those of its method "
    "action_masks(), or else of info['action_mask'].",
    "initial_q": "The initial Q table: drawn uniformly from a range, one number everywhere, or that of a saved run.",
}
"""The help of the settings whose values look different on the command line."""
_LONG = 60
"""Choices that take more characters are listed in the help text."""


def add_settings(parser: Parser, defaults: Mapping[str, Any]) -> None:
    """Adds a flag for each setting but ``env``. A flag that is not given is not in the result.

    Args:
        parser: The parser.
        defaults: The defaults that ``--help`` shows.
    """
    types = get_type_hints(Config)
    for title, names in groups(DEFAULTS.keys() - {"env"}).items():
        group = parser.add_argument_group(f"{title.lower()} options")
        for name in names:
            group.add_argument(flag(name), dest=name, default=SUPPRESS, **_flag(name, types[name], defaults[name]))


def given_settings(options: Namespace) -> dict[str, Any]:
    """Returns the settings that are given as flags."""
    return {name: getattr(options, name) for name in DEFAULTS if name != "env" and name in options}


def _flag(name: str, type_: Any, default: Any) -> dict[str, Any]:
    """Returns the arguments of ``add_argument``."""
    text = f"{_EXPLANATIONS.get(name, explanations().get(name, ''))} {applicability(name)}".strip()
    optional = NoneType in get_args(type_)
    kind = get_args(type_)[0] if optional else type_
    read, metavar, several = _READERS.get(name) or _READERS.get(kind) or (str, "NAME", False)
    if name in CHOICES:
        read, listed = values.choice(CHOICES[name]), ",".join(CHOICES[name])
        if len(listed) <= _LONG:
            metavar = f"{{{listed}}}"
        else:
            text += f" One of {', '.join(CHOICES[name])}."
    if optional:
        read = values.or_none(read)
    how = {"action": Together, "nargs": "*", "read": read} if several else {"type": read}
    return {**how, "metavar": metavar, "help": f"{text} (default: {_shown(default)})".replace("%", "%%")}


def _shown(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}"
    return values.words_of(value) or "none"


def read_config(path: Path) -> dict[str, Any]:
    """Returns the settings in a TOML file.

    Raises:
        OSError: if the file cannot be read.
        ValueError: if it is not TOML, or holds an unknown setting.
    """
    settings = read_toml("--config", path)
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
    """Returns the settings with the Q table of a saved run if ``initial_q`` is its file.

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

"""The error for an unknown setting, which suggests the nearest known one."""

import inspect
from collections.abc import Callable, Collection, Iterable
from functools import wraps
from typing import ParamSpec, TypeVar

from qtab._utils.shown import nearest, shown
from qtab.config.options import SETTINGS

P = ParamSpec("P")
T = TypeVar("T")

_ARGUMENTS = {
    "discretizer": "discretization features",
    "seeds": "n_seeds num_seeds n_runs num_runs runs",
    "threads": "n_jobs num_workers workers n_threads num_threads",
    "progress": "verbose progress_bar",
}
_OTHER_NAMES = {name: setting.other_names for name, setting in SETTINGS.items()} | _ARGUMENTS
"""The names of the settings and of the functions' arguments in other libraries and textbooks."""
_STEPS = ("total_timesteps", "n_timesteps", "num_timesteps", "timesteps", "total_steps")

_OF_ENVIRONMENTS = (
    *("is_slippery", "map_name", "desc", "success_rate", "reward_schedule", "is_rainy", "fickle_passenger"),
    *("natural", "sab", "goal_velocity", "gravity", "sutton_barto_reward", "continuous", "enable_wind"),
)
"""Arguments of Gymnasium's environments, which belong in ``env_kwargs``."""


def check_names(names: Iterable[str], known: Collection[str], function: str = "train", kind: str = "setting") -> None:
    """Rejects unknown settings.

    Args:
        names: The names given.
        known: The settings, and any other arguments that could have been meant.
        function: The public function whose help lists them.
        kind: The word for them in the message.

    Raises:
        TypeError: names the first unknown setting and, if there is one, the nearest known one.
    """
    for name in names:
        if name not in known:
            raise TypeError(f"unknown {kind} {shown(name)}{_suggestion(name, known, function, kind)}")


def suggesting(function: Callable[P, T]) -> Callable[P, T]:
    """Makes a function suggest the nearest argument for an unknown keyword."""
    known = inspect.signature(function).parameters

    @wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> T:
        check_names(kwargs, known, function.__name__, "argument")
        return function(*args, **kwargs)

    return checked


def meant(name: str, known: Collection[str]) -> str | None:
    """Returns the known name that was probably meant; None if there is none."""
    if name in _STEPS and "episodes" in known:
        return "episodes"
    names = {other: ours for ours, others in _OTHER_NAMES.items() if ours in known for other in others.split()}
    names |= {word: word for word in known}
    found = name if name in names else nearest(name, names)
    return None if found is None else names[found]


def _suggestion(name: str, known: Collection[str], function: str, kind: str) -> str:
    takes_env_kwargs = "env_kwargs" in known
    if takes_env_kwargs and name in _OF_ENVIRONMENTS:
        return f" (did you mean {_as_env_kwargs(name)}?)"
    found = meant(name, known)
    if found is None:
        command = " and qtab train --help list" if function == "train" else " lists"
        is_setting = takes_env_kwargs and kind == "setting"
        own = f"; arguments of an environment are given as {_as_env_kwargs(name)}" if is_setting else ""
        return f"; help(qtab.{function}){command} the {kind}s{own}"
    counted = " qtab counts episodes, not steps" if name in _STEPS else ""
    return f" (did you mean {found!r}?{counted})"


def _as_env_kwargs(name: str) -> str:
    return f"env_kwargs={{{shown(name)}: ...}}"

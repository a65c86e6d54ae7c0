"""Matching of environment objects to registry entries: Rust replaces only those whose numbers it reproduces."""

from collections.abc import Iterator, Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from gymnasium.wrappers import OrderEnforcing, PassiveEnvChecker, TimeLimit

from qtab.envs.origin.class_code import changed_library_code, is_of_library
from qtab.envs.registry import TABULAR, TABULATED, EnvEntry, entry_for_id

# The wrappers of gymnasium.make, none of which changes an observation or a reward.
_HARMLESS_WRAPPERS = (OrderEnforcing, PassiveEnvChecker, TimeLimit)

_CHANGING_WRAPPERS = {
    gym.ObservationWrapper: "observations",
    gym.RewardWrapper: "rewards",
    gym.ActionWrapper: "actions",
}
"""What the wrappers of each kind change. A run without them would be another one."""

# The attributes that a subclass of TabularEnv may define without changing its resets and steps.
_NOT_STEPPING = {
    *("__init__", "__repr__", "__str__", "metadata", "render", "render_mode", "close"),
    *("__module__", "__doc__", "__dict__", "__weakref__", "__annotations__", "__parameters__", "__orig_bases__"),
    *("__firstlineno__", "__static_attributes__", "__annotate_func__", "__annotations_cache__"),
    "__slotnames__",  # Python adds it when an object of the class is copied or pickled
}

# The attributes of wrappers besides their arguments: a reference, a cache, and whether one was closed.
_IRRELEVANT = ("env", "_cached_spec", "close_called")


class NotInRustError(ValueError):
    """Rust cannot step an environment. The message gives the reason.

    Args:
        reason: The reason.
        remedy: A change after which Rust steps it.
        problems: All problems of its code for Numba, with their remedies; empty for another reason.
    """

    def __init__(self, reason: str, remedy: str, problems: Sequence[str] = ()) -> None:
        super().__init__(reason)
        self.remedy, self.problems = remedy, tuple(problems)


def rust_unavailable(reason: str | NotInRustError, backend: str = "rust") -> ValueError:
    """Returns the error for a backend that insists on Rust, or on Numba, if Rust cannot step the environment."""
    if isinstance(reason, NotInRustError) and reason.problems:
        return ValueError(_not_compiled(reason.problems, backend))
    if backend == "numba" and isinstance(reason, NotInRustError):
        reason = f"{reason}; {reason.remedy}" if reason.remedy else str(reason)
    return ValueError(f"backend must be 'auto' or 'gymnasium' for this environment, got {backend!r}: {reason}")


def _not_compiled(problems: Sequence[str], backend: str) -> str:
    headline = f"the environment cannot be compiled, as backend={backend!r} asks"
    if len(problems) == 1:
        return f"{headline}: {problems[0]}"
    return "\n".join([f"{headline}, for these reasons:", *(f"  {problem}" for problem in problems)])


def entry_for_env(env: gym.Env) -> EnvEntry:
    """Returns the registry entry that computes the same numbers as an environment object.

    The generator and the state of the object do not matter: training starts with ``reset(seed=...)``.

    Raises:
        NotInRustError: if there is none; it names the class, wrapper or attribute that rules it out.
    """
    unwrapped: Any = env.unwrapped
    entry = _entry_for_class(unwrapped)
    if (changed := changed_library_code(type(unwrapped))) is not None:
        raise NotInRustError(f"{changed} was replaced", "Gymnasium's own code is stepped in Rust")
    check_known_wrappers(env, "as gymnasium.make returns it")
    for layer in layers(env):
        for name in vars(layer):
            if callable(getattr(type(layer), name, None)):
                raise _changed(f"its method {name} was replaced")
    for name in ("observation_space", "action_space"):
        if getattr(env, name) != getattr(unwrapped, name):
            raise _changed(f"its {name} was changed from {getattr(unwrapped, name)!r} to {getattr(env, name)!r}")
    if not entry.has_table:  # Rust reads a table from the object, so no attribute can be out of date
        _check_attributes(unwrapped, entry)
    return entry


def _entry_for_class(unwrapped: Any) -> EnvEntry:
    name, spec = type(unwrapped).__qualname__, unwrapped.spec
    entry = entry_for_id(spec.id) if spec is not None else None
    if entry is None or _entry_point(unwrapped) not in (entry.gymnasium_entry_point, entry.entry_point):
        if _is_tabular(unwrapped):
            return _table_entry(unwrapped)
        made = " without an id of Gymnasium's" if spec is None and type(unwrapped).__module__.startswith("gym") else ""
        remedy = "an environment whose transition table is known can be a qtab.TabularEnv, others a qtab.FunctionalEnv"
        if made:
            remedy = "pass the environment that gymnasium.make returns for the id"
        elif not is_of_library(type(unwrapped)):
            remedy += "; backend='numba' compiles many classes as they are"
        raise NotInRustError(f"Rust does not implement {name}{made}", remedy)
    return entry


def _is_tabular(unwrapped: Any) -> bool:
    """Returns whether it is a :class:`qtab.TabularEnv` or of a subclass. The class is imported only if one exists."""
    return any(f"{base.__module__}:{base.__qualname__}" == TABULAR.entry_point for base in type(unwrapped).__mro__)


def _table_entry(unwrapped: Any) -> EnvEntry:
    """Returns the entry of a table. A subclass may add attributes and pictures, but not change resets and steps."""
    from qtab.envs.tabular import TabularEnv

    cls = type(unwrapped)
    for base in cls.__mro__[: cls.__mro__.index(TabularEnv)]:
        for name in vars(base):
            if hasattr(TabularEnv, name) and name not in _NOT_STEPPING:
                raise NotInRustError(
                    f"its class {base.__name__} overrides {name}",
                    "a subclass of qtab.TabularEnv that leaves reset and step as they are is stepped in Rust",
                )
    for name, count in (("observation_space", len(unwrapped.P)), ("action_space", len(unwrapped.P[0]))):
        if getattr(unwrapped, name) != spaces.Discrete(count):
            raise NotInRustError(
                f"its {name} is {getattr(unwrapped, name)!r}, its table has {count}",
                "leave the spaces as qtab.TabularEnv makes them",
            )
    return TABULAR


def _check_attributes(unwrapped: Any, entry: EnvEntry) -> None:
    from qtab._core import parameter_names

    default = type(unwrapped)(**(unwrapped.spec.kwargs if unwrapped.spec is not None else {}))
    for name in ("observation_space", "action_space"):
        if getattr(unwrapped, name) != getattr(default, name):
            raise _changed(f"its {name} was changed from {getattr(default, name)!r} to {getattr(unwrapped, name)!r}")
    for name in parameter_names(entry.name):
        value, default_value = getattr(unwrapped, name), getattr(default, name)
        if type(value) not in (int, float, bool, str, list) or value != default_value:
            raise _changed(f"its attribute {name} was changed from {default_value!r} to {value!r}")


def _changed(reason: str) -> NotInRustError:
    return NotInRustError(reason, "pass the environment as gymnasium.make returns it")


def layers(env: gym.Env) -> Iterator[gym.Env]:
    """Yields the wrappers of an environment, the outermost first, and the environment in them."""
    while isinstance(env, gym.Wrapper):
        yield env
        env = env.env
    yield env


def overridden(cls: type, owner: type) -> tuple[type, str] | None:
    """Returns the class that overrides ``reset`` or ``step`` of a base class, and which; None if none does.

    Args:
        cls: The class.
        owner: The base class.
    """
    for base in cls.__mro__[: cls.__mro__.index(owner)]:
        for name in ("reset", "step"):
            if name in vars(base):
                return base, name
    return None


def unknown_wrapper(env: gym.Env) -> str | None:
    """Returns the class name of the outermost wrapper that may change a number; None if there is none."""
    wrapper = _unknown_wrapper(env)
    return None if wrapper is None else type(wrapper).__name__


def check_known_wrappers(env: gym.Env, how: str = "") -> None:
    """Checks that no wrapper of an environment may change a number.

    Args:
        env: The environment.
        how: How to pass it without its wrapper, for the message.

    Raises:
        NotInRustError: if one may; it names the wrapper.
    """
    wrapper = _unknown_wrapper(env)
    if wrapper is None:
        return
    changed = next((what for kind, what in _CHANGING_WRAPPERS.items() if isinstance(wrapper, kind)), None)
    if changed is None:
        remedy = "pass the environment without this wrapper" + (f", {how}" if how else "")
    else:
        remedy = f"compute its {changed} in the environment itself, such as a qtab.FunctionalEnv"
    raise NotInRustError(f"Rust does not implement its wrapper {type(wrapper).__name__}", remedy)


def _unknown_wrapper(env: gym.Env) -> Any:
    *wrappers, _ = layers(env)
    return next((wrapper for wrapper in wrappers if type(wrapper) not in _HARMLESS_WRAPPERS), None)


def time_limit(env: gym.Env) -> int | None:
    """Returns the time limit in steps, the lowest of several; None without one.

    It is that of ``TimeLimit`` wrappers, and the attribute ``max_episode_steps`` of an environment in a capsule or of a
    ``TabulatedEnv``.
    """
    limits = [layer._max_episode_steps for layer in layers(env) if isinstance(layer, TimeLimit)]
    unwrapped: Any = env.unwrapped
    if hasattr(type(unwrapped), "__qtab_env__") or _entry_point(unwrapped) == TABULATED:
        own = getattr(unwrapped, "max_episode_steps", None)
        limits += [] if own is None else [own]
    return min(limits, default=None)


def equal_environments(one: gym.Env, other: gym.Env) -> bool:
    """Returns whether two environments are known to be equal: the same wrappers and classes with equal attributes."""
    ours, theirs = list(layers(one)), list(layers(other))
    if [type(layer) for layer in ours] != [type(layer) for layer in theirs]:
        return False
    return all(_equal(_attributes(layer), _attributes(twin)) for layer, twin in zip(ours, theirs, strict=True))


def _attributes(layer: gym.Env) -> dict[str, Any]:
    return {name: value for name, value in vars(layer).items() if name not in _IRRELEVANT}


def _equal(one: Any, other: Any) -> bool:
    if type(one) is not type(other):
        return False
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(_equal(one[name], other[name]) for name in one)
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    try:
        return bool(one == other)
    except ValueError:  # arrays in lists
        return False


def _entry_point(env: gym.Env) -> str:
    return f"{type(env).__module__}:{type(env).__qualname__}"


__all__ = [
    "NotInRustError",
    "check_known_wrappers",
    "entry_for_env",
    "equal_environments",
    "rust_unavailable",
    "time_limit",
    "unknown_wrapper",
]

"""Ordinary Gymnasium classes under the backend "auto": when they are compiled, and why not.

A class is compiled only where nothing can differ from Python: nobody else can see the environment object, and no code
of the user runs during the training except ``reset`` and ``step``. ``compiled_by_default`` lists the conditions.

A compilation with its proof takes about as long as 100,000 steps in Python. Where a goal is learned, a run takes about
half of the steps that episodes of random actions would take, so that a class is compiled from 200,000 of them. Both
were timed on the same busy machine, in seconds of CPU time, for classes of the tests:

=============  =======================  =======================  =====================
class          compilation, with proof  loading of stored code   100,000 steps, Python
=============  =======================  =======================  =====================
CliffEnv       2.5                      0.06                     2.8
KeyDoorEnv     4.5                      0.07                     5.6
ThermostatEnv  2.7                      0.2                      2.6
InventoryEnv   3.2                      0.06                     6.6
PendulumEnv    2.7                      0.2                      1.9
=============  =======================  =======================  =====================

The rule depends on settings only, not on times or stored code, and both backends give the same numbers.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from qtab import _core
from qtab.config import Config
from qtab.envs.external.capsule import compiled_class, external_of, has_capsule
from qtab.envs.in_rust.matching import NotInRustError
from qtab.envs.in_rust.native import check_not_shown
from qtab.envs.origin.class_code import is_of_library
from qtab.training.setup.expected_steps import expected_steps, most_steps
from qtab.training.setup.use import Use
from qtab.training.setup.visibility import close_reads, is_sole_reference, is_visible

if TYPE_CHECKING:
    from qtab.compilation.ordinary import OrdinaryEnv

LEAST_STEPS = 200_000
"""The steps from which a class is compiled: episodes times their length with random actions, times the runs."""

OBJECT = ", and by default where qtab makes the environment from its id, so that nobody else can read the object"

SHORT = "it is compiled only for runs of about {least:,} steps or more, unless backend='numba' asks for it"

_QUIET = {"warn", "ignore"}
"""The modes of ``np.seterr`` that change no result; a class that warns in its first episodes is not compiled."""


@dataclass(frozen=True)
class _Class:
    """An environment that may be compiled, and what is known about its use."""

    env: gym.Env
    config: Config
    use: Use


_BEFORE: tuple[tuple[Callable[[_Class], Any], str], ...] = (
    (lambda one: one.use.watched, "{found}; otherwise, or with backend='numba', its class is compiled"),
    (
        lambda one: callable(one.config.action_mask),
        "a function as action_mask may read the environment; write a method action_masks(self) of the class",
    ),
    (
        lambda one: callable(one.config.discretizer) or one.config.max_rows is not None,
        "a function as the discretizer, or max_rows, reads each observation in Python",
    ),
    (
        lambda one: most_steps(one.env, one.config) * one.use.runs < _least_steps(),
        SHORT,
    ),
    (lambda one: _variation(one), "{found}"),
    (lambda one: is_visible(one.env), "its constructor, or other code, keeps a reference to the environment object"),
    (lambda _: not _QUIET.issuperset(np.geterr().values()), "np.seterr lets NumPy raise or report errors in its steps"),
    (lambda _: _warnings_are_errors(), "warnings are errors here, which NumPy may raise in its steps"),
)
"""Conditions that hold before a class is compiled, with the reasons if one does not."""

_REWRITTEN: tuple[tuple[Callable[[gym.Env, "OrdinaryEnv"], Any], str], ...] = (
    (
        lambda _, one: one.outside.message,
        "{found}: gymnasium.logger is called, whose messages compiled code leaves out; remove the call",
    ),
    (lambda _, one: one.rewritten.left_out, "{found}"),
    (lambda env, _: _space_of_user(env), "its space {found} is a class of your own, which Python may call"),
    (
        lambda env, _: next((name for name in ("observation_space", "action_space") if _is_computed(env, name)), None),
        "its {found} is a property; assign it in __init__",
    ),
    (
        lambda env, one: next(iter(_held_elsewhere(env, one)), None),
        "other code keeps a reference to self.{found}, which is changed in place; copy it in __init__",
    ),
    (
        lambda env, one: close_reads(env, one.rewritten.changed),
        "its method close may read {found}, which steps change in Python only",
    ),
)
"""Conditions that hold before a class that can be rewritten is compiled, with the reasons if one does not."""


def compiled_by_default(
    env: gym.Env, config: Config, use: Use | None, is_ours: bool, not_in_rust: NotInRustError
) -> tuple[_core.ExternalEnv | None, str | None]:
    """Returns an ordinary class as Rust steps it, else None, and the reason with a remedy.

    Args:
        env: The environment, perhaps in the wrappers of ``gymnasium.make``.
        config: The settings given.
        use: How the call uses the environment; None if the call never compiles by default.
        is_ours: Whether the environment was made for this run.
        not_in_rust: The reason why Rust does not step it without compilation.
    """
    reason = f"{not_in_rust}; {not_in_rust.remedy}" if not_in_rust.remedy else str(not_in_rust)
    cls = type(env.unwrapped)
    of_this_package = any(base.__module__.partition(".")[0] == "qtab" for base in cls.__mro__)  # as of a TabularEnv
    if use is None or has_capsule(env) or is_of_library(cls) or of_this_package:
        return None, reason
    if not is_ours:
        return None, f"{reason}{OBJECT}"
    from qtab.compilation.functional import is_installed

    if not is_installed():
        return None, f"{not_in_rust}; with Numba (pip install 'qtab[numba]'), such a class can be compiled"
    for condition, text in _BEFORE:
        if found := condition(_Class(env, config, use)):
            return None, f"{not_in_rust}, and {text.format(found=found, least=_least_steps())}"
    try:
        check_not_shown(env)
        return external_of(
            compiled_class(env, config.action_mask is True, partial(_check_rewritten, _Class(env, config, use)))
        ), None
    except NotInRustError as error:
        return None, f"{error}; {error.remedy}" if error.remedy else str(error)
    except Exception as error:  # of Numba, such as an import that fails; Python can step the environment
        return None, f"it could not be compiled: {type(error).__name__}: {error}"


def _check_rewritten(one: _Class, rewritten: "OrdinaryEnv") -> None:
    for condition, text in _REWRITTEN:
        if found := condition(one.env.unwrapped, rewritten):
            raise NotInRustError(text.format(found=found), "")
    if expected_steps(one.env, one.config, rewritten) * one.use.runs < _least_steps():
        name = type(one.env.unwrapped).__name__
        raise NotInRustError(f"Rust does not implement {name}, and {SHORT.format(least=_least_steps())}", "")


def _variation(one: _Class) -> str | None:
    """Returns why the environments of several runs may differ, or why making them may have effects."""
    if one.use.maker is None:
        return None
    from qtab.compilation import NotCompilable
    from qtab.compilation.twins.constructors import refuse_variation

    try:
        refuse_variation(one.use.maker, one.env.unwrapped)
    except NotCompilable as refusal:
        return f"each run makes an environment, which may differ: {refusal}"
    return None


def _warnings_are_errors() -> bool:
    """Returns whether a warning of NumPy may be raised as an error: the first filter that fits decides."""
    for action, message, category, module, line in warnings.filters:
        if issubclass(RuntimeWarning, category):
            if action == "error":
                return True
            if message is None and module is None and line == 0:
                return False
    return False


def _least_steps() -> int:
    return LEAST_STEPS


def _is_computed(env: gym.Env, name: str) -> bool:
    """Returns whether an attribute is a property or another descriptor of the class."""
    member = next((vars(base)[name] for base in type(env).__mro__ if name in vars(base)), None)
    return hasattr(type(member), "__get__")


def _space_of_user(env: gym.Env) -> str | None:
    """Returns the class of a space, or of a space within it, that is not one of Gymnasium's."""
    waiting: list[gym.Space[Any]] = [env.observation_space, env.action_space]
    while waiting:
        space = waiting.pop()
        if not is_of_library(type(space)):
            return type(space).__name__
        inner = getattr(space, "spaces", ())
        waiting += inner.values() if isinstance(inner, dict) else inner
    return None


def _held_elsewhere(env: gym.Env, one: "OrdinaryEnv") -> list[str]:
    return [name for name in sorted(one.rewritten.changed_in_place) if not is_sole_reference(env, name)]

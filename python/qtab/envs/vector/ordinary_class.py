"""Ordinary Gymnasium classes in a vector environment: compiled by Numba, if that shows nothing else than Python."""

import ast
import functools
import inspect
from collections.abc import Callable
from types import FunctionType
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from qtab.envs.external.capsule import compiled_class
from qtab.envs.in_rust.matching import NotInRustError

if TYPE_CHECKING:
    from qtab.compilation.ordinary import OrdinaryEnv


def compiled(make: Callable[[], gym.Env], env: gym.Env, is_same_step: bool) -> "OrdinaryEnv":
    """Returns a class as Rust steps it in a vector environment.

    Args:
        make: Makes a sub-environment.
        env: One that it has made, which was not stepped.
        is_same_step: Whether the last observation of an episode is shown, as the class returns it.

    Raises:
        NotInRustError: if it cannot be compiled, or if a vector environment shows more than compiled code gives.
    """

    def check(one: "OrdinaryEnv") -> None:
        shown = one.rewritten.shown
        refusals = [shown.refusal, shown.other_dtype, shown.view] if is_same_step else [shown.refusal]
        for refusal in refusals:
            if refusal is not None:
                raise refusal
        _check_arguments(env)
        _check_copies(env, make, one)

    return compiled_class(env, False, check)


def _check_arguments(env: gym.Env) -> None:
    """Refuses actions of another dtype, and a ``reset`` that does not take what a vector environment passes."""
    if env.action_space.dtype != np.int64:
        raise NotInRustError(f"its actions are {env.action_space.dtype}", "leave out dtype, for actions of int64")
    signature = inspect.signature(type(env.unwrapped).reset)
    try:
        bound = signature.bind(env, seed=None, options=None)
    except TypeError as error:
        reason, remedy = (
            f"reset does not take seed and options: {error}",
            "define reset(self, *, seed=None, options=None)",
        )
        raise NotInRustError(reason, remedy) from None
    default = signature.parameters["options"].default if "options" in bound.arguments else None
    if default is not None:
        raise NotInRustError("options of reset have no default None", "define reset(self, *, seed=None, options=None)")


def _check_copies(env: gym.Env, make: Callable[[], gym.Env], one: "OrdinaryEnv") -> None:
    """Refuses sub-environments that differ in what steps use, or that share memory in which they write."""
    other = make()
    try:
        _compare(vars(env.unwrapped), vars(other.unwrapped), one)
    finally:
        other.close()


def _compare(ours: dict[str, Any], theirs: dict[str, Any], one: "OrdinaryEnv") -> None:
    from qtab.compilation.twins.plain_data import is_plain, mutable_parts, same

    if ours.get("_np_random") is not None:
        reason = "its constructor resets it, or draws from self.np_random"
        raise NotInRustError(reason, "do not reset in `__init__`, nor draw")
    for name in sorted(one.rewritten.used & (ours.keys() | theirs.keys())):
        both = [values.get(name) for values in (ours, theirs)]
        is_equal = same if all(map(is_plain, both)) and not isinstance(both[0], gym.Space) else _equal
        if not is_equal(*both) or (name in ours) != (name in theirs):
            raise NotInRustError(f"two environments that are made differ in self.{name}", "make equal ones")
    for name in sorted(one.rewritten.changed_in_place & ours.keys()):
        for part in mutable_parts(ours[name]):
            for another in (other_part for value in theirs.values() for other_part in mutable_parts(value)):
                arrays = isinstance(part, np.ndarray) and isinstance(another, np.ndarray)
                if part is another or (arrays and np.may_share_memory(part, another)):
                    reason = f"self.{name} is changed in place, and all sub-environments share its memory"
                    raise NotInRustError(reason, f"copy it in __init__, as in self.{name} = array.copy()")


def _equal(one: object, other: object) -> bool:
    try:
        return one is other or (type(one) is type(other) and bool(one == other))
    except Exception:  # of the user's class
        return False


@functools.cache
def reads_options(cls: type) -> bool:
    """Returns whether ``reset`` of a compiled class may read its options, more than to pass them on."""
    from qtab.compilation.rewriting.source.sources import source_of

    for base in cls.__mro__[: cls.__mro__.index(gym.Env)]:
        reset = vars(base).get("reset")
        if reset is None:
            continue
        if not isinstance(reset, FunctionType):
            return True
        node = source_of(reset).node
        if node.args.kwarg is not None or node.args.vararg is not None:
            return True
        passed_on = [
            id(keyword.value)
            for call in ast.walk(node)
            if isinstance(call, ast.Call) and ast.unparse(call.func) == "super().reset"
            for keyword in call.keywords
            if keyword.arg == "options"
        ]
        if any(
            isinstance(one, ast.Name) and one.id == "options" and id(one) not in passed_on for one in ast.walk(node)
        ):
            return True
    return False

"""Whether other code can see an environment that was made for a run."""

import ast
import sys
import weakref
from types import FunctionType
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.envs.in_rust.matching import layers

HELD = "the function that makes the environment, or its constructor, keeps a reference to the object"


def references(value: Any) -> int:
    """Returns the number of references to a value, for a comparison with those to a new object in the same function."""
    return sys.getrefcount(value)


def is_visible(env: gym.Env) -> bool:
    """Returns whether other code may see an environment, or one of its inner layers.

    That is the case if anything but the wrapper of a layer refers to it, if there are weak references, or if anything
    but the layer refers to the dict of its attributes. References to the outermost layer are not counted: the function
    that has made it knows them.
    """
    new = gym.Wrapper(gym.Env())
    expected = _references_of_wrapped(new), _references_of_attributes(new)
    for layer in layers(env):
        if weakref.getweakrefcount(layer) or _references_of_attributes(layer) > expected[1]:
            return True
        if isinstance(layer, gym.Wrapper) and _references_of_wrapped(layer) > expected[0]:
            return True
    return False


def _references_of_wrapped(wrapper: "gym.Wrapper[Any, Any, Any, Any]") -> int:
    return sys.getrefcount(vars(wrapper)["env"])


def _references_of_attributes(layer: gym.Env) -> int:
    return sys.getrefcount(vars(layer))


def is_sole_reference(env: gym.Env, name: str) -> bool:
    """Returns whether an attribute holds the only reference to its value, an array or a list."""
    value = vars(env).get(name)
    if value is None:
        return True
    sample = {name: np.zeros(1)}
    is_view = isinstance(value, np.ndarray) and value.base is not None
    del value
    return not is_view and sys.getrefcount(vars(env)[name]) <= sys.getrefcount(sample[name])


def close_reads(env: gym.Env, changed: frozenset[str]) -> str | None:
    """Returns what a user's method ``close`` may read of the attributes that steps change; None if it reads none.

    Args:
        env: The environment, without wrappers.
        changed: The names of these attributes.
    """
    from qtab.compilation import NotCompilable
    from qtab.compilation.rewriting.source.sources import source_of

    if "close" in vars(env):
        return "all attributes"
    for base in type(env).__mro__[: type(env).__mro__.index(gym.Env)]:
        close = vars(base).get("close")
        if close is None:
            continue
        try:
            node = source_of(close).node if isinstance(close, FunctionType) else None
        except NotCompilable:
            node = None
        if node is None or not node.args.args:
            return "all attributes"
        if (found := _reads(env, node, node.args.args[0].arg, changed)) is not None:
            return found
    return None


def _is_close(node: ast.Attribute) -> bool:
    """Returns whether an attribute is that of ``super().close``."""
    owner = node.value
    is_super = isinstance(owner, ast.Call) and isinstance(owner.func, ast.Name) and owner.func.id == "super"
    return is_super and node.attr == "close" and not owner.args  # type: ignore[attr-defined]


def _reads(env: gym.Env, node: ast.AST, own: str, changed: frozenset[str]) -> str | None:
    direct = {id(one.value) for one in ast.walk(node) if isinstance(one, ast.Attribute)}
    attributes: list[Any] = [one for one in ast.walk(node) if isinstance(one, ast.Attribute)]
    closes = {id(one.value.func) for one in attributes if _is_close(one)}
    for one in ast.walk(node):
        if isinstance(one, ast.Name) and one.id in ("super", "__class__") and id(one) not in closes:
            return "all attributes"
        if isinstance(one, ast.Name) and one.id == own and id(one) not in direct:
            return "all attributes"
        if isinstance(one, ast.Attribute) and isinstance(one.value, ast.Name) and one.value.id == own:
            if one.attr in changed or one.attr in ("np_random", "_np_random"):
                return f"self.{one.attr}"
            member = getattr(type(env), one.attr, None)
            if isinstance(member, FunctionType | property) or one.attr in ("__dict__", "unwrapped"):
                return "all attributes"
    return None

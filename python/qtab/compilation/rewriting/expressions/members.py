"""Attributes: of the environment, of constants, and of arrays."""

import ast
import dataclasses
import enum
from types import FunctionType, ModuleType, SimpleNamespace
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from qtab.compilation.rewriting import specials
from qtab.compilation.rewriting.attributes import MISSING, own_attribute
from qtab.compilation.rewriting.expressions import calls
from qtab.compilation.rewriting.values import Array, Value, constant, in_words
from qtab.compilation.twins.own_code import runs_code

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

ARRAY_ATTRIBUTES = ("shape", "size", "ndim", "dtype")
GENERATORS = (np.random.Generator, np.random.RandomState)


def attribute(scope: "Expressions", node: ast.Attribute, base: Value) -> Value:
    """Returns the value of ``base.name``."""
    name = node.attr
    if base.fixed is specials.SELF:
        return of_environment(scope, node, name)
    if isinstance(base.fixed, specials.Super):
        member, owner = scope.program.attributes.find(name, base.fixed.after)
        return _member(scope, node, name, member, owner)
    if base.fixed is specials.RNG:
        raise scope.refuse(
            node, "the random generator is used other than by calling its methods", "call its methods here"
        )
    if base.is_fixed and not specials.is_special(base.fixed):
        return _of_constant(scope, node, base.fixed, name)
    if isinstance(base.kind, Array):
        scope.no_effects(base, node)
        if name == "ndim":
            return constant(base.kind.ndim)
        if name in ("shape", "size") and base.kind.shape is not None:
            return constant(base.kind.shape if name == "shape" else int(np.prod(base.kind.shape)))
        if name == "dtype":
            return constant(np.dtype(base.kind.dtype))
    shown = in_words(base.kind) if base.kind is not None else "this object"
    raise scope.refuse(node, f"the attribute {name} of {shown}", "use numbers and NumPy arrays")


def of_environment(scope: "Expressions", node: ast.AST, name: str) -> Value:
    """Returns the value of ``self.name``."""
    program = scope.program
    known = program.attributes
    member, owner = known.find(name)
    if name == "np_random" and owner is gym.Env:
        return constant(specials.RNG)
    if name in ("_np_random", "np_random_seed", "_np_random_seed"):
        raise scope.refuse(node, f"self.{name} is read", "draw from self.np_random")
    if name == "unwrapped" and owner is gym.Env:
        return constant(specials.SELF)
    if isinstance(member, FunctionType | property | staticmethod | classmethod):
        if name in getattr(program.env, "__dict__", {}):
            raise scope.refuse(node, f"the method {name} was replaced on the object", "define it in the class")
        return _member(scope, node, name, member, owner)
    if name in known.assigned:
        return scope.load_state(name, node)
    is_descriptor = member is not MISSING and hasattr(type(member), "__get__") and not isinstance(member, type)
    if is_descriptor and type(member).__name__ != "member_descriptor":
        raise scope.refuse(node, f"self.{name} is a {type(member).__name__}", "write a method or a property")
    value = getattr(program.env, name, MISSING)
    if value is MISSING:
        raise scope.refuse(node, f"self.{name} does not exist", f"set self.{name} in __init__")
    return constant(value)


def _member(scope: "Expressions", node: ast.AST, name: str, member: Any, owner: type | None) -> Value:
    program = scope.program
    if member is MISSING or owner is None:
        raise scope.refuse(node, f"the attribute {name} of a base class does not exist", "correct the name")
    if isinstance(member, property):
        if not isinstance(member.fget, FunctionType):
            raise scope.refuse(node, f"the property {name} has no function in Python", "write a method")
        return calls.user_call(scope, node, member.fget, owner, [constant(specials.SELF)], {})
    if isinstance(member, staticmethod):
        return constant(specials.Bound(member.__func__, owner, None))
    if isinstance(member, classmethod):
        return constant(specials.Bound(member.__func__, owner, constant(program.attributes.cls)))
    if isinstance(member, FunctionType):
        return constant(specials.Bound(member, owner, constant(specials.SELF)))
    return constant(member)


def _of_constant(scope: "Expressions", node: ast.Attribute, value: Any, name: str) -> Value:
    plain = isinstance(value, ModuleType | type | gym.spaces.Space | enum.Enum | SimpleNamespace | np.generic)
    if isinstance(value, np.ndarray) and name in ARRAY_ATTRIBUTES:
        return constant(getattr(value, name))
    if isinstance(value, GENERATORS):
        raise scope.refuse(node, "a second random generator", "draw from self.np_random")
    is_tuple = isinstance(value, tuple) and hasattr(value, "_fields")
    if plain or is_tuple or dataclasses.is_dataclass(value):
        if runs_code(value, name):
            reason = f"the attribute {name} of {type(value).__name__} is computed by code, which would run only once"
            raise scope.refuse(node, reason, "write a method of the environment")
        found = getattr(value, name, MISSING)
    else:
        found = own_attribute(value, name)
    if isinstance(found, property) or found is MISSING:
        kind = type(value).__name__
        raise scope.refuse(
            node, f"the attribute {name} of an object of type {kind}", "copy the number to self in __init__"
        )
    return constant(found)

"""Values that exist only while a class is rewritten: ``self``, its generator, the seed, methods."""

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.values import Value

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions


class Special:
    """A value that exists only while a class is rewritten.

    Args:
        name: Its name in messages.
    """

    def __init__(self, name: str) -> None:
        self.name = name


SELF, RNG, SEED = Special("self"), Special("self.np_random"), Special("seed")


@dataclass(frozen=True, eq=False)
class Super(Special):
    """``super()`` in a method."""

    after: type
    name = "super()"


@dataclass(frozen=True, eq=False)
class Bound(Special):
    """A method with its object."""

    function: Any
    owner: type
    receiver: Value | None
    """The first argument; None for a static method."""
    name = "a method"


def is_special(value: Any) -> bool:
    """Returns whether a constant exists only while a class is rewritten."""
    return isinstance(value, Special)


def refused_special(scope: "Expressions", node: ast.AST, value: Value) -> NotCompilable:
    """Returns the error for a use of ``self``, the generator or the seed that has no meaning in compiled code."""
    if value.fixed is SEED:
        return scope.refuse(
            node, "the seed is used", "pass it only to super().reset(seed=seed), and use self.np_random"
        )
    name = value.fixed.name
    return scope.refuse(node, f"{name} is passed on or compared", f"use {name} directly in the environment's methods")

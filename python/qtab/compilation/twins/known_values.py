"""What the names and attributes in a function stand for, before it is run."""

import ast
import builtins
import inspect
import operator
from collections.abc import Callable
from types import ModuleType
from typing import Any

import gymnasium as gym

from qtab.compilation.rewriting.attributes import MISSING, Attributes, own_attribute
from qtab.compilation.rewriting.source.sources import Source
from qtab.compilation.rewriting.source.syntax import Names, own_name
from qtab.compilation.rewriting.values import own_operator
from qtab.compilation.twins.own_code import runs_code
from qtab.compilation.twins.plain_data import is_plain

COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda one, other: one in other,
    ast.NotIn: lambda one, other: one not in other,
}


class KnownValues:
    """The values in a function of an environment.

    Args:
        env: The environment.
        known: Its attributes.
        source: The function.
        receiver: ``"self"`` or ``"class"`` if its first argument is the environment or its class, else ``""``.
    """

    def __init__(self, env: gym.Env, known: Attributes, source: Source, receiver: str) -> None:
        self._env, self._known = env, known
        self.names = Names(source)
        """The local names."""
        self.imported: dict[str, Any] = {}
        """What the function has imported."""
        first = own_name(source.node) or ""
        self._own = first if receiver == "self" else ""
        self._class = first if receiver == "class" else ""
        closure = inspect.getclosurevars(source.function)
        self._globals = {**vars(builtins), **source.function.__globals__, **closure.nonlocals}

    def is_own(self, node: ast.expr) -> bool:
        """Returns whether an expression is the environment."""
        return isinstance(node, ast.Name) and node.id == self._own != ""

    def value(self, node: ast.expr) -> Any:
        """Returns the value of a name or an attribute that no method of the environment assigns, else ``MISSING``."""
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, ast.Name):
            if node.id in self.imported:
                return self.imported[node.id]
            if node.id == self._class != "":
                return type(self._env)
            return MISSING if self.names.is_local(node.id) else self._globals.get(node.id, MISSING)
        if not isinstance(node, ast.Attribute):
            return MISSING
        if self.is_own(node.value):
            if node.attr in self._known.assigned:
                return MISSING
            value = vars(self._env).get(node.attr, self._known.find(node.attr)[0])
            return MISSING if hasattr(type(value), "__get__") and not isinstance(value, type) else value
        owner = self.value(node.value)
        if owner is MISSING:
            return MISSING
        if isinstance(owner, ModuleType | type) or is_plain(owner):
            return MISSING if runs_code(owner, node.attr) else getattr(owner, node.attr, MISSING)
        return own_attribute(owner, node.attr)

    def known_condition(self, node: ast.expr) -> Any:
        """Returns the truth of a condition that is the same at every step, else ``MISSING``."""
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            inner = self.known_condition(node.operand)
            return inner if inner is MISSING else not inner
        if isinstance(node, ast.BoolOp):
            is_and = isinstance(node.op, ast.And)
            values = [self.known_condition(one) for one in node.values]
            if any(value is not MISSING and value != is_and for value in values):
                return not is_and
            return MISSING if MISSING in values else is_and
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            item = self.value if isinstance(node.ops[0], ast.Is | ast.IsNot) else self._item
            sides = [item(one) for one in (node.left, node.comparators[0])]
            try:
                return MISSING if any(one is MISSING for one in sides) else bool(COMPARISONS[type(node.ops[0])](*sides))
            except (TypeError, ValueError):
                return MISSING
        value = self._item(node)
        return bool(value) if isinstance(value, bool | int | float | str | type(None)) else MISSING

    def _item(self, node: ast.expr) -> Any:
        """Returns the value of a constant that can be compared, also of a display of constants."""
        if isinstance(node, ast.List | ast.Tuple | ast.Set):
            items = [self._item(one) for one in node.elts]
            return MISSING if MISSING in items else items
        value = self.value(node)
        is_compared = isinstance(value, bool | int | float | str | tuple | list | type(None))
        return value if is_compared and is_plain(value) and own_operator(value) is None else MISSING

"""Expressions in which Python can neither raise an error nor warn, whatever the state is."""

import ast
import builtins
from dataclasses import dataclass
from types import FunctionType
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.attributes import MISSING
from qtab.compilation.rewriting.source.sources import source_of
from qtab.compilation.rewriting.statements.effects import resolved
from qtab.compilation.rewriting.values import BOOL, FLOAT, INT, WIDE, Array, Kind, TupleKind, kind_of

if TYPE_CHECKING:
    from qtab.compilation.rewriting.program import Program

STALE = "stale attribute "
"""The beginning of the entries in a flow of attributes that are assigned and never read, and so are left out."""
DEPTH = 4
"""The most functions that call each other."""


@dataclass
class LeftOut:
    """An expression that is left out, with what is known where it is."""

    function: FunctionType
    node: ast.AST
    line: int
    file: str
    own: str
    """The name of the environment in the function; empty without one."""
    local: dict[str, Kind | None]
    """The variables that are set, with the kinds of those that are known."""
    names: frozenset[str]
    """All local names."""
    assigned: frozenset[str]
    """The attributes that are certainly assigned, by ``reset`` or before."""
    refused: bool = False
    """Whether it is refused, whatever it is."""


class Failures:
    """Finds a part of an expression that might raise an error or warn.

    Args:
        program: The program, with all that is known about the attributes.
        place: Where the expression is.
        depth: How many functions are around it.
        numbers: The attributes that are left out, and are assumed to be numbers.
    """

    def __init__(
        self, program: "Program", place: LeftOut, depth: int = 0, numbers: frozenset[str] = frozenset()
    ) -> None:
        self._program, self._place, self._depth = program, place, depth
        self._numbers = numbers
        self._env, self._known = program.env, program.attributes

    def fails(self, node: ast.AST) -> ast.AST | None:
        """Returns a part of an expression that might raise an error or warn; None without any."""
        if isinstance(node, ast.Dict):
            if not all(isinstance(key, ast.Constant) for key in node.keys):
                return node
            return self._any(
                [one for key, one in zip(node.keys, node.values, strict=True) if not self._is_mask(key, one)]
            )
        if isinstance(node, ast.List | ast.Tuple):
            return self._any(node.elts)
        if isinstance(node, ast.IfExp):
            return self._any([node.body, node.orelse]) if self._kind(node.test) in WIDE else node
        if isinstance(node, ast.JoinedStr):
            parts = [one for one in node.values if isinstance(one, ast.FormattedValue)]
            return next((one for one in parts if one.format_spec or self._kind(one.value) not in WIDE), None)
        if isinstance(node, ast.Compare) and len(node.ops) == 1 and isinstance(node.ops[0], ast.Is | ast.IsNot):
            return self._any([node.left, *node.comparators])
        if isinstance(node, ast.Call):
            return self._call(node)
        if isinstance(node, ast.Constant) or self._is_there(node):
            return None
        return None if self._kind(node) is not None else node

    def _is_mask(self, key: Any, value: ast.expr) -> bool:
        """Returns whether a value of the info dict is the action mask, which is compiled."""
        if not isinstance(key, ast.Constant) or key.value != "action_mask" or "action_mask" not in self._program.named:
            return False
        has_method = self._known.find("action_masks")[0] is not MISSING
        return not has_method or (ast.unparse(value) == f"{self._place.own}.action_masks()" and self._place.own != "")

    def _any(self, nodes: "list[ast.expr]") -> ast.AST | None:
        return next((found for one in nodes if (found := self.fails(one)) is not None), None)

    def _is_there(self, node: ast.AST) -> bool:
        """Returns whether a name, or an attribute of the environment, exists whenever it is read."""
        place = self._place
        if isinstance(node, ast.Name):
            if node.id in place.names or node.id in place.local:
                return node.id in place.local and node.id != place.own
            return resolved(node, place.function) is not MISSING
        if not isinstance(node, ast.Attribute):
            return False
        if not self._is_own(node.value):
            return resolved(node, place.function) is not MISSING
        member, _ = self._known.find(node.attr)
        if isinstance(member, property):
            return self._function_is_safe(member.fget)
        if hasattr(type(member), "__get__") and not isinstance(member, FunctionType):
            return False
        return node.attr in vars(self._env) or member is not MISSING or self._is_assigned(node.attr)

    def _is_assigned(self, name: str) -> bool:
        return not self._place.assigned.isdisjoint((name, f"{STALE}{name}"))

    def _is_own(self, node: ast.expr) -> bool:
        return isinstance(node, ast.Name) and node.id == self._place.own != ""

    def _kind(self, node: ast.AST) -> Kind | None:
        """Returns the kind of an expression that neither raises an error nor warns, if it is a number or an array."""
        if isinstance(node, ast.Constant):
            return kind_of(node.value)
        if isinstance(node, ast.Name) and node.id in self._place.names:
            return self._place.local.get(node.id)
        if isinstance(node, ast.Name):
            return kind_of(resolved(node, self._place.function))
        if isinstance(node, ast.Attribute):
            return self._kind_of_attribute(node)
        if isinstance(node, ast.UnaryOp):
            kind = self._kind(node.operand)
            return (BOOL if isinstance(node.op, ast.Not) else INT if kind == BOOL else kind) if kind in WIDE else None
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub | ast.Mult):
            return self._joined(self._kind(node.left), self._kind(node.right))
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            ordered = isinstance(node.ops[0], ast.Eq | ast.NotEq | ast.Lt | ast.LtE | ast.Gt | ast.GtE)
            return BOOL if ordered and {self._kind(node.left), self._kind(node.comparators[0])} <= set(WIDE) else None
        if isinstance(node, ast.BoolOp):
            kinds = {self._kind(one) for one in node.values}
            return kinds.pop() if len(kinds) == 1 and kinds <= set(WIDE) else None
        if isinstance(node, ast.Subscript):
            return self._element(node)
        if isinstance(node, ast.Call):
            return self._kind_of_call(node)
        return None

    def _joined(self, one: Kind | None, other: Kind | None) -> Kind | None:
        """Returns the kind of a sum, difference or product of numbers, or of arrays of integers of equal shapes."""
        if isinstance(one, Array) and isinstance(other, Array):
            return one if one == other and one.dtype == "int64" and one.shape is not None else None
        if one not in WIDE or other not in WIDE:
            return None
        return INT if one in (BOOL, INT) and other in (BOOL, INT) else one if other in (BOOL, INT) else other

    def _kind_of_attribute(self, node: ast.Attribute) -> Kind | None:
        if not self._is_own(node.value):
            return kind_of(resolved(node, self._place.function))
        member, _ = self._known.find(node.attr)
        if hasattr(type(member), "__get__"):
            return None
        if node.attr in self._known.kinds:
            return self._known.kinds[node.attr]
        first = kind_of(vars(self._env).get(node.attr, member))
        if node.attr not in self._known.assigned:
            return first
        if node.attr in self._numbers:
            return FLOAT
        values = self._program.stale.get(node.attr, [])
        if first not in WIDE and (node.attr in vars(self._env) or not self._is_assigned(node.attr)):
            return None
        numbers = self._numbers | {node.attr}
        inner = [Failures(self._program, one, self._depth, numbers)._kind(one.node) for one in values]
        return FLOAT if inner and all(kind in WIDE for kind in inner) else None

    def _element(self, node: ast.Subscript) -> Kind | None:
        """Returns the kind of an element at a constant index, which exists."""
        owner, index = self._kind(node.value), node.slice
        if (
            isinstance(index, ast.UnaryOp)
            and isinstance(index.op, ast.USub)
            and isinstance(index.operand, ast.Constant)
        ):
            index = ast.Constant(-index.operand.value if isinstance(index.operand.value, int) else None)
        if not isinstance(index, ast.Constant) or type(index.value) is not int:
            return None
        if isinstance(owner, TupleKind) and index.value in range(-len(owner.items), len(owner.items)):
            return owner.items[index.value]
        is_vector = isinstance(owner, Array) and owner.ndim == 1 and owner.shape is not None
        if is_vector and index.value in range(-owner.shape[0], owner.shape[0]):  # type: ignore[union-attr, index]
            return kind_of(np.zeros(1, owner.dtype)[0])  # type: ignore[union-attr]
        return None

    def _kind_of_call(self, node: ast.Call) -> Kind | None:
        found = resolved(node.func, self._place.function)
        kinds = [self._kind(one) for one in node.args]
        if found is np.linalg.norm and len(kinds) == 1 and isinstance(kinds[0], Array):
            is_order = all(one.arg == "ord" and isinstance(one.value, ast.Constant) for one in node.keywords)
            orders = [one.value.value for one in node.keywords] if is_order else ["unknown"]  # type: ignore[attr-defined]
            of_integers = kinds[0].dtype == "int64" and kinds[0].ndim == 1
            return FLOAT if of_integers and all(one in (None, 1, 2) for one in orders) else None
        if isinstance(node.func, ast.Attribute) and node.func.attr == "sum" and not (node.args or node.keywords):
            owner = self._kind(node.func.value)
            return INT if isinstance(owner, Array) and owner.dtype in ("bool", "int64") else None
        if len(kinds) != 1 or node.keywords or kinds[0] not in WIDE:
            return None
        if found is builtins.int:
            return INT if kinds[0] in (BOOL, INT) else None
        if found is builtins.abs:
            return INT if kinds[0] == BOOL else kinds[0]
        return FLOAT if found is builtins.float else BOOL if found is builtins.bool else None

    def _call(self, node: ast.Call) -> ast.AST | None:
        if self._kind_of_call(node) is not None:
            return None
        function, found = node.func, resolved(node.func, self._place.function)
        if found is builtins.dict and not node.args and all(one.arg for one in node.keywords):
            return self._any([one.value for one in node.keywords])
        if isinstance(function, ast.Attribute) and not node.args and not node.keywords:
            if self._is_own(function.value):
                member, _ = self._known.find(function.attr)
                return None if self._function_is_safe(member) else node
            if function.attr in ("copy", "tolist") and isinstance(self._kind(function.value), Array):
                return None
        is_simple = found in (builtins.list, builtins.tuple, builtins.str, builtins.repr) if callable(found) else False
        if is_simple and len(node.args) == 1 and not node.keywords:
            kind = self._kind(node.args[0])
            wanted = kind in WIDE if found in (builtins.str, builtins.repr) else isinstance(kind, Array | TupleKind)
            return None if wanted else node
        return node

    def _function_is_safe(self, function: Any) -> bool:
        """Returns whether a method without arguments only assigns variables and returns an expression."""
        if not isinstance(function, FunctionType) or self._depth >= DEPTH:
            return False
        try:
            source = source_of(function)
        except NotCompilable:
            return False
        arguments = source.node.args
        own = [one.arg for one in (*arguments.posonlyargs, *arguments.args)]
        if len(own) != 1 or arguments.kwonlyargs or arguments.vararg or arguments.kwarg:
            return False
        stored = {
            one.id for one in ast.walk(source.node) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
        }
        local: dict[str, Kind | None] = {}
        names = frozenset({*own, *stored})
        assigned = self._place.assigned
        place = LeftOut(function, source.node, source.node.lineno, source.file, own[0], local, names, assigned)
        search = Failures(self._program, place, self._depth + 1, self._numbers)
        for statement in source.node.body:
            value: Any = getattr(statement, "value", None)
            if isinstance(statement, ast.Expr) and isinstance(value, ast.Constant):
                continue
            if isinstance(statement, ast.Return):
                return value is None or search.fails(value) is None
            targets = statement.targets if isinstance(statement, ast.Assign) else []
            if len(targets) != 1 or not isinstance(targets[0], ast.Name) or search.fails(value) is not None:
                return False
            local[targets[0].id] = search._kind(value)
        return True

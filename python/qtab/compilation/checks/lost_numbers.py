"""Mixed numbers that go where they are not followed: into containers, arrays, and functions of these."""

import operator
from typing import Any

from numba.core import ir, types

from qtab.compilation.checks.checked_operations import INPLACE
from qtab.compilation.checks.known_functions import NUMPY_OF_FLOATS
from qtab.compilation.checks.mixed_numbers import NUMBER, MixedNumbers, converted, is_whole
from qtab.compilation.checks.number_types import leaf
from qtab.compilation.checks.typed_code import TypedCode

_CONTAINERS = (types.List, types.ListType, types.Set, types.DictType)
_TAKE = ("append", "insert", "add", "extend")
"""Methods whose last argument becomes an element; the first may be an index."""
MAKE_ARRAYS = {"array": 1, "asarray": 1, "full": 2}
"""Functions of NumPy whose dtype follows from the numbers, unless it is the argument at this position."""


class LostNumbers:
    """The mixed numbers that are lost in the code of one function.

    Args:
        code: The code.
        mixed: Its mixed numbers.
    """

    def __init__(self, code: TypedCode, mixed: MixedNumbers) -> None:
        self._code, self._mixed = code, mixed

    def in_statement(self, statement: Any) -> bool:
        """Returns whether mixed numbers go into a container, or into a function of sequences."""
        value = getattr(statement, "value", None)
        if isinstance(statement, ir.SetItem | ir.StaticSetItem):
            of = self._code.type_of(statement.target)
            return isinstance(of, _CONTAINERS) and self._mixes(value, of)
        if not isinstance(statement, ir.Assign) or not isinstance(value, ir.Expr):
            return False
        if value.op in ("binop", "inplace_binop"):
            function = INPLACE.get(value.fn, value.fn)
            sides = (value.lhs, value.rhs)
            return function in (operator.add, operator.mul) and any(self._mixed.of(one) - {NUMBER} for one in sides)
        if value.op in ("getitem", "static_getitem"):
            index = value.index if value.op == "getitem" else value.index_var
            is_slice = index is not None and isinstance(self._code.type_of(index), types.SliceType)
            return is_slice and bool(self._mixed.of(value.value))
        return value.op == "call" and self._in_call(value)

    def in_numpy(self, expression: Any, name: str) -> bool:
        """Returns whether a call of a function of NumPy has another type for the integers than for the floats."""
        given = [*expression.args, *(one for _, one in expression.kws)]
        if not any(map(self._mixed.of, given)) or name in NUMPY_OF_FLOATS:
            return False
        position = MAKE_ARRAYS.get(name)
        has_dtype = position is not None and (len(expression.args) > position or "dtype" in dict(expression.kws))
        return not has_dtype and not (position == 1 and any(map(self._has_float, given)))

    def in_array(self, left: Any, right: Any) -> bool:
        """Returns whether an operator of arrays has another type for the integers than for the floats."""
        sides = (left, right)
        kinds = [leaf(self._code.type_of(one)) for one in sides]
        return any(map(self._mixed.is_mixed, sides)) and any(map(is_whole, kinds))

    def _has_float(self, variable: Any) -> bool:
        """Returns whether a sequence that is written out has a number that is always a float."""
        found = self._code.definition(variable)
        if isinstance(found, ir.Expr) and found.op in ("build_list", "build_tuple"):
            return any(map(self._has_float, found.items))
        of = types.unliteral(self._code.type_of(variable))
        return isinstance(of, types.Float) and not self._mixed.is_mixed(variable)

    def _in_call(self, call: Any) -> bool:
        called = self._code.typemap[call.func.name]
        if isinstance(called, types.BoundFunction) and isinstance(called.this, _CONTAINERS):
            key = called.typing_key
            name = key[1] if isinstance(key, tuple) else str(key).rpartition(".")[2]
            found = self._code.definition(call.func)
            if isinstance(found, ir.Expr) and found.op == "getattr" and self._mixed.of(found.value):
                return name not in (*_TAKE, "clear") or any(map(self._mixed.of, call.args))
            takes = name in _TAKE and bool(call.args)
            return any(map(self._mixed.of, call.args)) or (takes and self._mixes(call.args[-1], called.this))
        key = called.typing_key if isinstance(called, types.Function) else None
        is_sequence = key in (sorted, enumerate, zip, reversed, list, tuple, set) or (
            key in (min, max) and len(call.args) == 1
        )
        return is_sequence and any(self._mixes(one) for one in call.args)

    def _mixes(self, variable: Any, container: Any = None) -> bool:
        """Returns whether a variable has mixed numbers, or is a tuple that, or a number which a container, mixes."""
        of = types.unliteral(self._code.type_of(variable))
        wanted = getattr(container, "value_type", getattr(container, "dtype", None))
        given = getattr(of, "dtype", of)
        if self._mixed.of(variable) or (wanted is not None and list(converted(given, wanted))):
            return True
        kinds = list(of) if isinstance(of, types.BaseTuple) and container is None else []
        return any(map(is_whole, kinds)) and any(isinstance(types.unliteral(one), types.Float) for one in kinds)

"""Refusals of lists, sets and dicts that compare, order or convert their elements otherwise in compiled code."""

import operator
from typing import Any

import numpy as np
from numba.core import ir, types

from qtab.compilation.checks.number_types import joins_boolean
from qtab.compilation.checks.typed_code import TypedCode

Refusal = tuple[str, str] | None
"""A reason and an advice; None if the construct is not refused."""

_KEYED = (types.Set, types.DictType)
_WITHOUT_ORDER = (len, sorted, min, max, sum, any, all, set, bool)
"""Functions whose results do not depend on the order of a set."""
_SEARCHES = ("index", "count", "remove")
_SETS_CHANGE = ("add", "discard", "remove", "clear")
_SORT = "sort integers, or search in a loop"
_DICTS_USED = ("get", "pop", "keys", "values", "items", "clear")
_NUMBERS = (types.Number, types.Boolean)
_SAME_FOR_BOOLEANS = (np.array, np.asarray, len)
_ONE_TYPE = "give all its numbers one type, such as 0.0 for 0"


def refused(code: TypedCode, statement: Any) -> Refusal:
    """Returns why a statement is refused, and what to write instead.

    Args:
        code: The code of the function.
        statement: The statement.
    """
    if isinstance(statement, ir.SetItem | ir.StaticSetItem):
        index = statement.index if isinstance(statement, ir.SetItem) else statement.index_var
        of, value = code.type_of(statement.target), types.unliteral(code.type_of(statement.value))
        held = getattr(of, "value_type", getattr(of, "dtype", None))
        if isinstance(of, types.List | types.DictType) and isinstance(value, _NUMBERS) and value != held:
            return f"{value} in {_in_words(of)} of {held}", _ONE_TYPE
        return _other_key(of, code, index)
    if not isinstance(statement, ir.Assign) or not isinstance(statement.value, ir.Expr):
        return None
    made, expression = code.type_of(statement.target), statement.value
    if isinstance(made, _KEYED) and holds_floats(_key(made)):
        return f"{_in_words(made)} of floats", "use integers as its elements, or compare numbers in a loop"
    if expression.op == "build_map" and _converts(code, made, expression.items):
        return "numbers of several types in a dict", "give all its keys, and all its values, one type"
    if expression.op == "build_list" and any(joins_boolean(code.type_of(one), made.dtype) for one in expression.items):
        return None if _is_same_for_booleans(code, statement) else _booleans(made)
    if expression.op == "getiter" and isinstance(code.type_of(expression.value), types.Set):
        return _order()
    if expression.op in ("getitem", "static_getitem"):
        index = expression.index if expression.op == "getitem" else expression.index_var
        return _other_key(code.type_of(expression.value), code, index)
    if expression.op in ("binop", "inplace_binop"):
        return _operation(code, expression)
    return _call(code, expression) if expression.op == "call" else None


def holds_floats(of: Any) -> bool:
    """Returns whether a type is that of floats, or of tuples or lists that have some."""
    of = types.unliteral(of)
    if isinstance(of, types.BaseTuple):
        return any(map(holds_floats, of))
    return holds_floats(of.dtype) if hasattr(of, "dtype") else isinstance(of, types.Float | types.Complex)


def _converts(code: TypedCode, made: Any, items: list[Any]) -> bool:
    given = {tuple(types.unliteral(code.type_of(one)) for one in item) for item in items}
    return isinstance(made, types.DictType) and not given <= {(made.key_type, made.value_type)}


def _booleans(of: Any) -> Refusal:
    """Refuses booleans among numbers: those of NumPy add as no number does."""
    return f"booleans in a list of {of.dtype}", "convert the booleans with int(...)"


def _is_same_for_booleans(code: TypedCode, statement: Any) -> bool:
    """Returns whether a list is only given to functions with the same result, such as one that makes an array."""
    name = statement.target.name
    for block in code.state.func_ir.blocks.values():
        for one in block.body:
            if one is statement or isinstance(one, ir.Del) or all(used.name != name for used in one.list_vars()):
                continue
            value = getattr(one, "value", None)
            if isinstance(value, ir.Expr) and value.op == "call":
                called = code.typemap[value.func.name]
                if isinstance(called, types.Function) and called.typing_key in _SAME_FOR_BOOLEANS:
                    continue
            is_kept = isinstance(value, ir.Var) or (isinstance(value, ir.Expr) and value.op == "build_list")
            if not (isinstance(one, ir.Assign) and is_kept and _is_same_for_booleans(code, one)):
                return False
    return True


def _operation(code: TypedCode, expression: Any) -> Refusal:
    left, right = (types.unliteral(code.type_of(one)) for one in (expression.lhs, expression.rhs))
    numbers = (types.Integer, types.Float, types.Boolean)
    if expression.fn in (operator.is_, operator.is_not) and isinstance(left, numbers) and isinstance(right, numbers):
        return "`is` compares objects", "write =="
    if expression.fn is operator.contains:
        return _other_key(left, code, expression.rhs)
    if not (isinstance(left, types.List) and isinstance(right, types.List)):
        return None
    if expression.fn in (operator.add, operator.iadd):
        return None if left.dtype == right.dtype else (f"a list of {left.dtype} and {right.dtype}", _ONE_TYPE)
    if left != right or holds_floats(left):
        kinds = "floats" if left == right else f"{left.dtype} and {right.dtype}"
        return f"a comparison of lists of {kinds}", "compare the elements in a loop"
    return None


def _call(code: TypedCode, expression: Any) -> Refusal:
    called = code.typemap[expression.func.name]
    given = [types.unliteral(code.type_of(one)) for one in expression.args]
    if isinstance(called, types.BoundFunction):
        key = called.typing_key
        name = key[1] if isinstance(key, tuple) else str(key).rpartition(".")[2]
        return _method(name, called.this, given, bool(expression.kws))
    function = called.typing_key if isinstance(called, types.Function) else None
    if function is sorted and (expression.kws or len(given) > 1 or holds_floats(given[0])):
        return f"sorted: {_unordered(given[0], len(given) > 1 or bool(expression.kws))}", _SORT
    is_ordered = isinstance(called, types.Function) and function not in _WITHOUT_ORDER
    return _order() if is_ordered and any(isinstance(one, types.Set) for one in given) else None


def _method(name: str, of: Any, given: list[Any], named: bool) -> Refusal:
    if isinstance(of, types.List):
        if name == "sort" and (given or named or holds_floats(of)):
            return f"list.sort: {_unordered(of, bool(given) or named)}", _SORT
        if name in ("append", "insert") and isinstance(given[-1], _NUMBERS) and given[-1] != of.dtype:
            return f"{given[-1]} in a list of {of.dtype}", _ONE_TYPE
        if name == "extend" and joins_boolean(getattr(given[0], "dtype", given[0]), of.dtype):
            return _booleans(of)
        if name in _SEARCHES and (holds_floats(of) or given[:1] != [of.dtype]):
            what = "of floats" if holds_floats(of) else f"of {given[0] if given else 'nothing'} in a list of {of.dtype}"
            return f"list.{name}() {what}", "compare the elements in a loop"
    elif isinstance(of, types.Set):
        if name not in _SETS_CHANGE:
            return f"set.{name}()", "use a list, or `in`"
        if given and given[0] != of.dtype:
            return _other(given[0], of)
    elif isinstance(of, types.DictType):
        if name not in _DICTS_USED:
            return f"dict.{name}()", "write d[key], or `key in d`"
        if given and given[0] != of.key_type:
            return _other(given[0], of)
        if len(given) > 1 and given[1] != of.value_type:
            return f"dict.{name} with {given[1]} beside {of.value_type}", "give a number of the same type"
    return None


def _other_key(of: Any, code: TypedCode, index: Any) -> Refusal:
    if not isinstance(of, _KEYED) or index is None:
        return None
    given = types.unliteral(code.type_of(index))
    return _other(given, of) if given != types.unliteral(_key(of)) else None


def _other(given: Any, of: Any) -> Refusal:
    return f"{given} beside {_key(of)} in {_in_words(of)}", "convert it: int(...)"


def _unordered(of: Any, has_arguments: bool) -> str:
    if holds_floats(of) and not has_arguments:
        return "the signs of zeros, and NaN, may stand in another order"
    return "equal elements may change their order"


def _order() -> Refusal:
    return "the order of a set", "use a tuple or a list"


def _key(of: Any) -> Any:
    return of.key_type if isinstance(of, types.DictType) else of.dtype


def _in_words(of: Any) -> str:
    return "a dict" if isinstance(of, types.DictType) else "a set" if isinstance(of, types.Set) else "a list"

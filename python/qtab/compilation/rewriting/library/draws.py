"""Draws from ``self.np_random``: the methods that draw the same numbers in compiled code as in NumPy."""

import ast
import inspect
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.checks.known_functions import DRAWS, DRAWS_OF_INTEGERS, draw_check
from qtab.compilation.rewriting.expressions import containers
from qtab.compilation.rewriting.library import bound
from qtab.compilation.rewriting.program import as_float, converted
from qtab.compilation.rewriting.values import (
    FLOAT,
    INT,
    WIDE,
    Array,
    Scalar,
    TupleKind,
    Value,
    constant,
    in_words,
    scalar_of,
)

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions


def draw(scope: "Expressions", node: ast.Call, name: str) -> Value:
    """Returns the value of ``self.np_random.name(...)``."""
    values, named = scope.arguments(node)
    program = scope.program
    if program.phase == "mask":
        raise scope.refuse(node, "an action mask draws random numbers", "draw in step, and keep the result in self")
    if program.phase == "reset" and not program.seeded:
        raise scope.refuse(node, "reset draws before super().reset(seed=seed)", "call super().reset(seed=seed) first")
    scope.compiled.draws = True
    if name == "integers":
        return _integers(scope, node, values, named)
    if name == "choice":
        return _choice(scope, node, values, named)
    if name == "permutation" and len(values) == 1 and not named:
        size = scope.lift(values[0], node)
        if size.kind == INT:
            shape = (size.fixed,) if isinstance(size.fixed, int) else None
            return Value(Array("int64", 1, shape), f"rng.permutation({size.code})", fresh=True)
        raise scope.refuse(node, f"permutation of {in_words(size.kind)}", "draw the indices with permutation(n)")
    if name not in DRAWS:
        advice = "use random, uniform, normal, integers, choice, permutation, exponential, poisson or binomial"
        raise scope.refuse(node, f"Generator.{name} cannot be compiled with the same draws", advice)
    check = draw_check(name)
    parameters = inspect.signature(check).parameters
    chosen = bound(scope, node, list(parameters), values, named)
    numbers = []
    for parameter in list(parameters)[:-1]:
        default = parameters[parameter].default
        value = chosen.get(parameter, constant(None if default is inspect.Parameter.empty else default))
        if value.is_fixed and value.fixed is None:
            raise scope.refuse(node, f"Generator.{name} without {parameter}", "give all arguments")
        numbers.append(_number(scope, node, value, parameter))
        if name == "binomial" and parameter == "n" and numbers[0].kind != INT:
            raise scope.refuse(node, f"Generator.{name} with n as {in_words(numbers[0].kind)}", "write int(...)")
    if all(number.is_fixed for number in numbers):
        try:
            check(*(number.fixed for number in numbers))
        except ValueError:
            raise scope.refuse(node, "arguments that NumPy does not allow", "correct them") from None
    codes = [number.code if number.kind == INT else as_float(number) for number in numbers]
    kind = INT if name in DRAWS_OF_INTEGERS else FLOAT
    return _sized(scope, node, f"rng.{name}", codes, chosen.get("size"), kind)


def _number(scope: "Expressions", node: ast.AST, value: Value, name: str) -> Value:
    value = scope.lift(value, node)
    if value.kind not in WIDE:
        raise scope.refuse(node, f"{in_words(value.kind)} as the argument {name}", "draw the numbers one by one")
    return value


def _sized(
    scope: "Expressions", node: ast.AST, function: str, codes: list[str], size: Value | None, kind: Scalar
) -> Value:
    if size is None or (size.is_fixed and size.fixed is None):
        return Value(kind, f"{function}({', '.join(codes)})")
    dtype = "int64" if kind == INT else "float64"
    if isinstance(size.fixed, int | np.integer):
        shape: tuple[int, ...] | None = (int(size.fixed),)
    elif isinstance(size.fixed, tuple | list) and all(isinstance(one, int | np.integer) for one in size.fixed):
        shape = tuple(int(one) for one in size.fixed)
    else:
        lifted = scope.lift(size, node)
        if lifted.kind != INT and not (isinstance(lifted.kind, TupleKind) and set(lifted.kind.items) == {INT}):
            raise scope.refuse(node, f"{in_words(lifted.kind)} as the size", "use an integer")
        ndim = 1 if lifted.kind == INT else len(lifted.kind.items)
        code = f"{function}({', '.join([*codes, f'size={lifted.code}'])})"
        return Value(Array(dtype, ndim), code, fresh=True)
    code = f"{function}({', '.join([*codes, f'size={shape}'])})"
    return Value(Array(dtype, len(shape or ()), shape), code, fresh=True)


def _integers(scope: "Expressions", node: ast.AST, values: list[Value], named: dict[str, Value]) -> Value:
    chosen = bound(scope, node, ["low", "high", "size", "dtype", "endpoint"], values, named)
    dtype = chosen.get("dtype", constant(np.int64))
    if not dtype.is_fixed or dtype.fixed not in (int, np.int64):
        raise scope.refuse(node, "integers with another dtype", "leave out dtype, and convert the number: np.int8(...)")
    endpoint = chosen.get("endpoint", constant(False))
    if not endpoint.is_fixed or "low" not in chosen:
        raise scope.refuse(node, "integers with these arguments", "write integers(low, high)")
    low, high = chosen["low"], chosen.get("high", constant(None))
    if high.is_fixed and high.fixed is None:
        low, high = constant(0), low
    low, high = _number(scope, node, low, "low"), _number(scope, node, high, "high")
    if low.kind != INT or high.kind != INT:
        raise scope.refuse(node, "integers with bounds that are not integers", "write int(...)")
    last = f"({high.code} + 1)" if endpoint.fixed else high.code
    return _sized(scope, node, "rng.integers", [low.code, last], chosen.get("size"), INT)


def _choice(scope: "Expressions", node: ast.AST, values: list[Value], named: dict[str, Value]) -> Value:
    chosen = bound(scope, node, ["a", "size", "replace", "p"], values, named)
    size, replace = chosen.get("size", constant(None)), chosen.get("replace", constant(True))
    if "a" not in chosen or size.fixed is not None or replace.fixed is not True:
        raise scope.refuse(node, "choice of several elements", "draw them one by one with choice or integers")
    pool = chosen["a"]
    count: Any = len(pool.fixed) if isinstance(pool.fixed, list | tuple | np.ndarray | range) else None
    if isinstance(pool.fixed, int | np.integer):
        count = int(pool.fixed)
    if count is None and not isinstance(pool.kind, Array) and pool.kind != INT:
        raise scope.refuse(node, f"choice from {in_words(pool.kind)}", "choose from a constant, or draw an index")
    p = chosen.get("p", constant(None))
    if p.fixed is None and p.is_fixed:
        if count is None:
            lifted = scope.lift(pool, node)
            code = lifted.code if pool.kind == INT else f"{lifted.code}.shape[0]"
            index = Value(INT, f"rng.integers(0, {code})")
        else:
            index = Value(INT, f"rng.integers(0, {count})")
    else:
        index = _weighted(scope, node, p, count)
    if isinstance(pool.fixed, int | np.integer) or pool.kind == INT:
        return index
    if isinstance(pool.fixed, list | tuple | range):
        numbers = list(pool.fixed)
        array = np.asarray(numbers)
        if array.ndim != 1 or array.dtype.kind not in "if":
            draw = f"integers(0, {count})" if p.is_fixed and p.fixed is None else f"choice({count}, p=...)"
            raise scope.refuse(node, "choice from something other than numbers", f"draw an index with {draw}")
        return containers.lookup(scope, node, array.tolist(), index)
    lifted = scope.lift(pool, node)
    if lifted.kind.ndim != 1:
        raise scope.refuse(node, "choice from a matrix", "draw an index with integers(0, n)")
    scalar = scalar_of(lifted.kind.dtype)
    return Value(scalar, converted(f"{lifted.code}[{index.code}]", scalar))


def _weighted(scope: "Expressions", node: ast.AST, p: Value, count: int | None) -> Value:
    """Returns an index that is drawn with constant probabilities, as ``Generator.choice`` does it."""
    if not p.is_fixed or count is None:
        raise scope.refuse(
            node, "choice with probabilities that change", "compare self.np_random.random() with their sums"
        )
    try:
        weights = np.asarray(p.fixed, dtype=np.float64)
        np.random.default_rng(0).choice(count, p=weights)
    except (TypeError, ValueError) as error:
        raise scope.refuse(node, f"choice with these probabilities ({error})", "correct them") from None
    cumulative = weights.cumsum()
    cumulative /= cumulative[-1]
    scope.compiled.uses.add("h_choice")
    return Value(INT, f"h_choice({scope.program.array(cumulative)}, rng.random())")

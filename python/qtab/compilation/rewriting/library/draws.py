"""Draws from ``self.np_random``: the methods that draw the same numbers in compiled code as in NumPy."""

import ast
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.compilation.rewriting.helpers.draw_checks import HELPERS
from qtab.compilation.rewriting.program import as_float
from qtab.compilation.rewriting.values import FLOAT, INT, WIDE, Array, Scalar, TupleKind, Value, constant, in_words

if TYPE_CHECKING:
    from qtab.compilation.rewriting.expressions.expressions import Expressions

PARAMETERS: dict[str, tuple[tuple[str, float | None], ...]] = {
    "random": (),
    "uniform": (("low", 0.0), ("high", 1.0)),
    "normal": (("loc", 0.0), ("scale", 1.0)),
    "standard_normal": (),
    "exponential": (("scale", 1.0),),
    "standard_exponential": (),
    "gamma": (("shape", None), ("scale", 1.0)),
    "beta": (("a", None), ("b", None)),
    "chisquare": (("df", None),),
    "standard_t": (("df", None),),
    "standard_cauchy": (),
    "poisson": (("lam", 1.0),),
    "binomial": (("n", None), ("p", None)),
    "geometric": (("p", None),),
    "triangular": (("left", None), ("mode", None), ("right", None)),
    "laplace": (("loc", 0.0), ("scale", 1.0)),
    "logistic": (("loc", 0.0), ("scale", 1.0)),
    "lognormal": (("mean", 0.0), ("sigma", 1.0)),
    "weibull": (("a", None),),
    "pareto": (("a", None),),
    "rayleigh": (("scale", 1.0),),
}
"""The methods, with the names and defaults of their parameters before ``size``."""
NOT_NEGATIVE, POSITIVE, PROBABILITY = "h_not_negative", "h_positive", "h_probability"
CONSTRAINTS: dict[tuple[str, str], str] = {
    **{(name, "scale"): NOT_NEGATIVE for name in ("normal", "exponential", "gamma", "laplace", "logistic", "rayleigh")},
    ("lognormal", "sigma"): NOT_NEGATIVE,
    ("gamma", "shape"): NOT_NEGATIVE,
    ("weibull", "a"): NOT_NEGATIVE,
    ("pareto", "a"): POSITIVE,
    ("beta", "a"): POSITIVE,
    ("beta", "b"): POSITIVE,
    ("chisquare", "df"): POSITIVE,
    ("standard_t", "df"): POSITIVE,
    ("poisson", "lam"): "h_poisson",
    ("binomial", "n"): NOT_NEGATIVE,
    ("binomial", "p"): PROBABILITY,
    ("geometric", "p"): "h_positive_probability",
}
"""What NumPy demands of an argument, by method and parameter: the helper that raises an error for other values."""
TOGETHER = {"uniform": "h_uniform", "triangular": "h_triangular"}
"""The methods whose arguments NumPy checks together, with helpers that return the last of them."""
INTEGERS = ("poisson", "binomial", "geometric")


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
    if name == "permutation" and len(values) == 1 and not named and _kind(scope, node, values[0]) == INT:
        size = values[0].fixed if isinstance(values[0].fixed, int) else None
        shape = None if size is None else (size,)
        return Value(
            Array("int64", 1, shape), f"rng.permutation({scope.lift(values[0], node).code})", fresh=True, effects=True
        )
    if name not in PARAMETERS:
        advice = "use random, uniform, normal, integers, choice, permutation, exponential, poisson or binomial"
        raise scope.refuse(node, f"Generator.{name} cannot be compiled with the same draws", advice)
    parameters = (*PARAMETERS[name], ("size", None))
    chosen = bound(scope, node, [one for one, _ in parameters], values, named)
    codes = []
    for parameter, default in PARAMETERS[name]:
        value = chosen.get(parameter, constant(default))
        if value.is_fixed and value.fixed is None:
            raise scope.refuse(node, f"Generator.{name} without {parameter}", "give all arguments")
        number = _number(scope, node, value, parameter)
        if name == "binomial" and parameter == "n" and number.kind != INT:
            raise scope.refuse(node, f"Generator.{name} with n as {in_words(number.kind)}", "write int(...)")
        codes.append(_allowed(scope, node, name, parameter, number))
    if name in TOGETHER:
        codes[-1] = _together(
            scope, node, name, [chosen.get(one, constant(default)) for one, default in PARAMETERS[name]]
        )
    kind = INT if name in INTEGERS else FLOAT
    return _sized(scope, node, f"rng.{name}", codes, chosen.get("size"), kind)


def _allowed(scope: "Expressions", node: ast.AST, name: str, parameter: str, number: Value) -> str:
    """Returns the code of an argument, which raises an error where NumPy does; a constant is checked now."""
    helper = CONSTRAINTS.get((name, parameter))
    if helper is None:
        return number.code
    if number.is_fixed:
        _check_constants(scope, node, helper, [number.fixed])
        return number.code
    scope.compiled.uses.add(helper)
    return f"{helper}({number.code if number.kind == INT else as_float(number)})"


def _together(scope: "Expressions", node: ast.AST, name: str, given: list[Value]) -> str:
    """Returns the code of the last argument of a method whose arguments NumPy checks together."""
    helper = TOGETHER[name]
    if all(value.is_fixed for value in given):
        _check_constants(scope, node, helper, [value.fixed for value in given])
        return scope.lift(given[-1], node).code
    for value in given[:-1]:
        scope.no_effects(value, node, "a call whose result is used several times")
    scope.compiled.uses.add(helper)
    return f"{helper}({', '.join(scope.lift(value, node).code for value in given)})"


def _check_constants(scope: "Expressions", node: ast.AST, helper: str, values: list[Any]) -> None:
    try:
        HELPERS[helper](*values)
    except (ValueError, OverflowError):
        raise scope.refuse(node, "arguments that NumPy does not allow", "correct them") from None


def bound(
    scope: "Expressions", node: ast.AST, names: Sequence[str], values: list[Value], named: dict[str, Value]
) -> dict[str, Value]:
    """Returns the arguments of a known function by name."""
    if len(values) > len(names) or not set(named) <= set(names):
        unknown = sorted(set(named) - set(names))
        what = f"the argument {unknown[0]}" if unknown else "so many arguments"
        raise scope.refuse(node, f"{what} of this function cannot be compiled", "leave it out")
    return {**dict(zip(names, values, strict=False)), **named}


def _kind(scope: "Expressions", node: ast.AST, value: Value) -> Any:
    return scope.lift(value, node).kind


def _number(scope: "Expressions", node: ast.AST, value: Value, name: str) -> Value:
    value = scope.lift(value, node)
    if value.kind not in WIDE:
        raise scope.refuse(node, f"{in_words(value.kind)} as the argument {name}", "draw the numbers one by one")
    return value


def _sized(
    scope: "Expressions", node: ast.AST, function: str, codes: list[str], size: Value | None, kind: Scalar
) -> Value:
    if size is None or (size.is_fixed and size.fixed is None):
        return Value(kind, f"{function}({', '.join(codes)})", effects=True)
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
        return Value(Array(dtype, ndim), code, fresh=True, effects=True)
    code = f"{function}({', '.join([*codes, f'size={shape}'])})"
    return Value(Array(dtype, len(shape or ()), shape), code, fresh=True, effects=True)


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
    from qtab.compilation.rewriting.expressions import containers

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
            index = Value(INT, f"rng.integers(0, {code})", effects=True)
        else:
            index = Value(INT, f"rng.integers(0, {count})", effects=True)
    else:
        index = _weighted(scope, node, p, count)
    if isinstance(pool.fixed, int | np.integer) or pool.kind == INT:
        return index
    if isinstance(pool.fixed, list | tuple | range):
        numbers = list(pool.fixed)
        array = np.asarray(numbers)
        if array.ndim != 1 or array.dtype.kind not in "if":
            raise scope.refuse(node, "choice from something other than numbers", "draw an index with integers(0, n)")
        return containers.lookup(scope, node, array.tolist(), index)
    lifted = scope.lift(pool, node)
    if lifted.kind.ndim != 1:
        raise scope.refuse(node, "choice from a matrix", "draw an index with integers(0, n)")
    from qtab.compilation.rewriting.program import converted
    from qtab.compilation.rewriting.values import scalar_of

    scalar = scalar_of(lifted.kind.dtype)
    return Value(scalar, converted(f"{lifted.code}[{index.code}]", scalar), effects=True)


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
    return Value(INT, f"h_choice({scope.program.array(cumulative)}, rng.random())", effects=True)

"""Random expressions of numbers compute in compiled code what they compute in Python, or are refused or repeated."""

import math
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from qtab.compilation import NotCompilable
from support.lockstep.compiled_expressions import FAILED, bits, in_functional_env, in_ordinary_class, in_python

pytest.importorskip("numba")

INTEGERS = [0, 1, -1, 2, -3, 7, 64, 300, 2**31, -(2**31) - 1, 2**53 - 1, 2**53, 2**53 + 1, -(2**53) - 1, 2**62,
            2**63 - 1, -(2**63)]  # fmt: skip
FLOATS = [0.0, -0.0, 0.5, -0.5, 1.0, -1.5, 2.5, 7.0, 5e-324, -5e-324, 2.2250738585072014e-308, 1e-7, 1e300, -1e300,
          float(2**53), -float(2**53), float(2**63), math.inf, -math.inf, math.nan]  # fmt: skip
LITERALS = ["0", "1", "2", "3", "-1", "7", "0.0", "-0.0", "0.5", "1.0", "2.5", "1e300", str(2**53), str(2**53 + 1),
            str(2**63 - 1), "math.inf", "math.nan", "math.pi", "True", "False"]  # fmt: skip
BINARY = ["+", "-", "*", "/", "//", "%", "**", "&", "|", "^", "<<", ">>"]
COMPARED = ["==", "!=", "<", "<=", ">", ">="]
ONE = ["abs", "int", "float", "bool", "round", "math.floor", "math.ceil", "math.trunc", "math.fabs", "math.sqrt",
       "math.sin", "math.cos", "math.tan", "math.atan", "math.exp", "math.log", "math.log1p", "math.expm1",
       "math.isnan", "math.isinf", "math.isfinite", "math.tanh", "np.sin", "np.cos", "np.sqrt", "np.floor", "np.ceil",
       "np.abs", "np.float32", "np.float64", "np.int64", "np.int8", "np.uint8"]  # fmt: skip
TWO = ["min", "max", "math.atan2", "math.copysign", "np.minimum", "np.maximum"]
ARRAYS = ["np.array([{}, {}])[{}]", "np.array([{}, {}], np.int8)[{}]", "np.array([{}, {}], np.float32)[{}]",
          "np.full(2, {}, np.int16)[0] + {} * {}", "np.full(2, {}, np.float32)[1] < {} + {}",
          "np.clip(np.array([{}, {}]), -0.0, 1.0)[{}]", "(np.array([{}, {}]) * {})[0]",
          "(np.array([{}, {}]) <= {})[1]"]  # fmt: skip


def _expressions(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    pairs = st.tuples(inner, inner)
    return st.one_of(
        st.builds("({1} {0} {2})".format, st.sampled_from(BINARY), inner, inner),
        st.builds("({1} {0} {2})".format, st.sampled_from(COMPARED), inner, inner),
        st.builds("({1} {0} {2} {0} {3})".format, st.sampled_from(COMPARED), inner, inner, inner),
        st.builds("(({1}, {2}) {0} ({3}, {4}))".format, st.sampled_from(COMPARED), inner, inner, inner, inner),
        st.builds("({0} {1} ({2}, {3}))".format, inner, st.sampled_from(["in", "not in"]), inner, inner),
        st.builds("(-{0})".format, inner),
        st.builds("(not {0})".format, inner),
        st.builds("(~{0})".format, inner),
        st.builds("({0} if {1} else {2})".format, inner, inner, inner),
        pairs.map(lambda two: f"({two[0]} and {two[1]})"),
        pairs.map(lambda two: f"({two[0]} or {two[1]})"),
        st.builds("{0}({1})".format, st.sampled_from(ONE), inner),
        st.builds("{0}({1}, {2})".format, st.sampled_from(TWO), inner, inner),
        st.builds("{0}({1}, {2}, {3})".format, st.sampled_from(["min", "max", "np.clip"]), inner, inner, inner),
        st.builds("({1}, {2})[{0}]".format, st.sampled_from([0, 1]), inner, inner),
        st.builds(lambda form, *parts: f"({form.format(*parts)})", st.sampled_from(ARRAYS), inner, inner, inner),
    )


EXPRESSIONS = st.recursive(
    st.one_of(st.sampled_from(["n", "m", "x", "y", "n", "x", "p", "q"]), st.sampled_from(LITERALS)),
    _expressions,
    max_leaves=6,
)
VALUES = st.tuples(
    st.sampled_from(INTEGERS) | st.integers(-(2**63), 2**63 - 1),
    st.sampled_from(INTEGERS),
    st.sampled_from(FLOATS) | st.floats(),
    st.sampled_from(FLOATS),
    st.booleans(),
    st.booleans(),
)


def differences(expression: str, compile_it: Callable[[str], Callable[..., Any]], values: list[Any]) -> list[Any]:
    """Returns the arguments for which an expression gives other numbers in compiled code, with both numbers."""
    try:
        compiled = compile_it(expression)
    except NotCompilable:
        return []
    python, found = in_python(expression), []
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        for one in values:
            result = compiled(*one)
            if result is FAILED:
                continue
            try:
                expected = bits(python(*one))
            except Exception as error:  # which the compiled code must raise, too
                expected = error
            if bits(result) != expected:
                found.append((expression, one, expected, bits(result)))
    return found


FOUND = [
    "min(round(m), (9007199254740993 or q), (q and n))",
    "(n / (3 if n else y))",
    "max(n, x) + m",
    "(n, p) != (x, q)",
    "np.full(2, n, np.int16)[0] == np.int16(m)",
]
"""Expressions that once differed."""
GRID = [(n, m, x, y, p, False) for n in INTEGERS for m in (2, -3, 2**63 - 1) for x in FLOATS[::3] for y in (-0.0, 2.5)
        for p in (True, False)]  # fmt: skip


@pytest.mark.parametrize("expression", FOUND)
def test_expressions_that_once_differed_give_the_numbers_of_python(expression: str) -> None:
    assert differences(expression, in_functional_env, GRID) == []


@pytest.mark.slow
@settings(max_examples=settings().max_examples // 3, suppress_health_check=list(HealthCheck))
@given(EXPRESSIONS, st.lists(VALUES, min_size=30, max_size=30))
def test_expressions_in_functional_environments_give_the_numbers_of_python(expression: str, values: list[Any]) -> None:
    assert differences(expression, in_functional_env, values) == []


@pytest.mark.slow
@settings(max_examples=settings().max_examples // 10, suppress_health_check=list(HealthCheck))
@given(EXPRESSIONS, st.lists(VALUES, min_size=30, max_size=30))
def test_expressions_in_ordinary_classes_give_the_numbers_of_python(expression: str, values: list[Any]) -> None:
    assert differences(expression, in_ordinary_class, values) == []

"""Integers never wrap: outside of 64 bits compiled code raises an error, and the step is repeated in Python."""

from types import FunctionType
from typing import Any

import numpy as np
import pytest

from qtab.compilation.rewriting import rewrite
from qtab.compilation.rewriting.helpers import helpers
from support.gym_classes import large_integers
from support.lockstep_rewriting import transformed

CLASSES = [
    value
    for value in vars(large_integers).values()
    if isinstance(value, type) and issubclass(value, large_integers.Counts)
]
WRAPPING = {"Doubles", "Adds", "Subtracts", "Shifts", "Powers", "Sums", "Compares", "Divides"}
LIMIT = 2**63


def outcome(functions: Any, cls: Any, ups: int) -> float | None:
    """Returns the reward of action 0 after ``ups`` times action 1; None if there was an error."""
    record = rewrite(cls()).initial.copy()[0:1][0]
    rng = np.random.Generator(np.random.PCG64(0))
    functions.reset(record, rng)
    try:
        for _ in range(ups):
            functions.step(record, 1, rng)
        return float(functions.step(record, 0, rng)[1])
    except OverflowError:
        return None


@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.__name__)
def test_numbers_are_those_of_the_class_or_an_error(cls: Any) -> None:
    numba: Any = pytest.importorskip("numba")
    compiled = transformed(rewrite(cls()), numba.njit(error_model="python", boundscheck=True))
    errors = 0
    for ups in (0, 1, 2, 3, 30, 34, 36, 61, 62, 63, 64, 65, 90, 130):
        env = cls()
        env.reset(seed=0)
        for _ in range(ups):
            env.step(1)
        expected = env.step(0)[1]
        found = outcome(compiled, cls, ups)
        assert found in (expected, None)
        assert found == outcome(rewrite(cls()), cls, ups)
        assert found is not None or ups > 3
        errors += found is None
    assert (errors > 0) == (cls.__name__ in WRAPPING)


EDGES = [0, 1, -1, 2, -2, 3, 62, 63, 64, 2**31, -(2**31), 2**32, 2**53, 2**53 + 1, LIMIT - 1, 1 - LIMIT, -LIMIT]
OPERATORS: dict[str, Any] = {
    "h_add": lambda one, other: one + other,
    "h_sub": lambda one, other: one - other,
    "h_mul": lambda one, other: one * other,
    "h_floordiv": lambda one, other: one // other,
    "h_shl": lambda one, other: one << other if other < 200 or not one else LIMIT,
    "h_shr": lambda one, other: one >> other,
    "h_ipow": lambda one, other: one**other if 0 <= other < 200 or one in (0, 1, -1) else LIMIT,
}


@pytest.mark.parametrize("name", OPERATORS)
def test_helpers_compute_exact_integers_or_raise(name: str) -> None:
    numba: Any = pytest.importorskip("numba")
    namespace: dict[str, Any] = {"np": np}
    for helper in ("h_neg", "h_mul", name):
        code = getattr(helpers, helper).__code__
        namespace[helper] = numba.njit(error_model="python")(FunctionType(code, namespace, helper))
    for one in EDGES:
        for other in EDGES:
            if name == "h_ipow" and other < 0:
                continue
            expected: Any
            try:
                expected = OPERATORS[name](one, other)
                expected = expected if -LIMIT <= expected < LIMIT else OverflowError
            except (ValueError, ZeroDivisionError) as error:
                expected = type(error)
            for function in (namespace[name], getattr(helpers, name)):
                found: Any
                try:
                    found = function(one, other)
                except (ValueError, ZeroDivisionError, OverflowError) as error:
                    found = type(error)
                assert found == expected, (function, one, other)

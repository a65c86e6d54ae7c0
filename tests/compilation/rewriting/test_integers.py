"""Integers never wrap: outside of 64 bits compiled code raises an error, and the step is repeated in Python."""

import operator
from typing import Any

import numpy as np
import pytest

from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes import large_integers
from support.lockstep.rewriting import assert_nothing_refused, compiled_with_checks

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
    pytest.importorskip("numba")
    compiled = compiled_with_checks(rewrite(cls()))
    errors = 0
    for ups in (0, 1, 2, 3, 30, 34, 36, 61, 62, 63, 64, 65, 90, 130):
        env = cls()
        env.reset(seed=0)
        for _ in range(ups):
            env.step(1)
        expected = env.step(0)[1]
        found = outcome(compiled, cls, ups)
        assert found in (expected, None)
        assert outcome(rewrite(cls()), cls, ups) in (expected, None)
        assert found is not None or ups > 3
        errors += found is None
    assert (errors > 0) == (cls.__name__ in WRAPPING)
    assert_nothing_refused()


EDGES = [0, 1, -1, 2, -2, 3, 62, 63, 64, 2**31, -(2**31), 2**32, 2**53, 2**53 + 1, LIMIT - 1, 1 - LIMIT, -LIMIT]
OPERATORS: dict[Any, Any] = {
    operator.add: operator.add,
    operator.sub: operator.sub,
    operator.mul: operator.mul,
    operator.floordiv: operator.floordiv,
    operator.mod: operator.mod,
    operator.lshift: lambda one, other: one << other if other < 200 or not one else LIMIT,
    operator.rshift: operator.rshift,
    operator.pow: lambda one, other: one**other if 0 <= other < 200 or one in (0, 1, -1) else LIMIT,
}
"""Operators by the function that computes them in Python, without results of billions of digits."""


@pytest.mark.parametrize("function", OPERATORS, ids=lambda function: function.__name__)
def test_operations_compute_exact_integers_or_raise(function: Any) -> None:
    numba: Any = pytest.importorskip("numba")
    from qtab.compilation.checks.checked_operations import INTEGER_OPERATIONS

    operation = INTEGER_OPERATIONS[function]
    compiled = numba.njit("int64(int64, int64)", error_model="python")(lambda one, other: operation(one, other))
    for one in EDGES:
        for other in EDGES:
            if function is operator.pow and other < 0:
                continue
            expected: Any
            try:
                expected = OPERATORS[function](one, other)
                expected = expected if -LIMIT <= expected < LIMIT else OverflowError
            except (ValueError, ZeroDivisionError) as error:
                expected = type(error)
            found: Any
            try:
                found = compiled(one, other)
            except (ValueError, ZeroDivisionError, OverflowError) as error:
                found = type(error)
            assert found == expected, (one, other)


@pytest.mark.parametrize("name", ["negative", "absolute"])
def test_signs_of_integers_are_exact_or_raise(name: str) -> None:
    numba: Any = pytest.importorskip("numba")
    from qtab.compilation.checks import checked_operations

    operation = getattr(checked_operations, name)
    compiled = numba.njit("int64(int64)", error_model="python")(lambda value: operation(value))
    for value in EDGES:
        expected = -value if name == "negative" else abs(value)
        if expected < LIMIT:
            assert compiled(value) == expected
        else:
            with pytest.raises(OverflowError):
                compiled(value)

"""Numbers in containers, sums, sorts and NumPy functions: refused, or repeated in Python, where they would differ."""

import math
from typing import Any

import numpy as np
import pytest

from qtab.compilation import NotCompilable
from qtab.compilation.proof import _first
from support.lockstep.compiled_expressions import FAILED, bits, in_functional_env, in_ordinary_class, in_python

pytest.importorskip("numba")

REFUSED = {
    # The type of the result depends on the branch.
    "-np.abs(max(0, x))": "sometimes an integer and sometimes a float",
    "-np.array([n if p else x])[0]": "sometimes an integer and sometimes a float",
    "np.full(2, max(0, x))[0]": "sometimes an integer and sometimes a float",
    "(np.array([n, m]) * max(0, x))[0]": "sometimes an integer and sometimes a float",
    "-[n, x].pop()": "sometimes an integer and sometimes a float",
    "(p if q else n) + p": "sometimes a boolean|arithmetic of booleans",  # the latter with Numba 0.61
    "-([n] + [x])[0]": "a list of int64 and float64",
    "[n, p][1] + p": "booleans in a list of int64",
    "([n] + [p])[1] + p": "a list of int64 and bool",
    "{n: m}.popitem()[1]": r"dict.popitem\(\)",
    # Sets, lists, sums and sorts.
    "x in {1, 2}": "float64 beside int64 in a set",
    "{n: np.float32(x), m: y}[n]": "numbers of several types in a dict",
    "len({x, y})": "a set of floats",
    "[n for n in {n, m}][0]": "the order of a set",
    "[n, m].count(x)": r"list.count\(\) of float64 in a list of int64",
    "[x] == [y]": "a comparison of lists of floats",
    "sum((n, p))": "a sum of integers and booleans",
    "sorted((x, y))[0]": "sorted: the signs of zeros, and NaN",
    "np.sort(np.array([x, y]))[0]": "equal elements may change their order",
    "np.argsort(np.array([n, m]))[0]": "search for the elements in a loop",
    "np.mean(np.array([n, m]))": "may add in another order",
    # Complex numbers, bits, objects.
    "(1j * x).real": "a complex number",
    "np.signbit(x)": "write math.copysign",
    "np.array([x]).view(np.int64)[0]": r"array.view\(\) shows the sign of a NaN",
    "np.sin(np.float32(x))": "write math.sin",
    "math.exp(np.float32(x))": "math.exp of a float32",
    "math.trunc(np.float32(x))": "math.trunc of a float32",
    "np.float32(x).item()": r"item\(\) of float32 keeps its dtype",
    "float(*(np.float32(x),))": r"a call with \*arguments",
    "(float if p else float)(np.float32(x))": "float of a float32 through a variable",
    "np.array([np.float32(x)]).item()": r"array.item\(\) of float32 keeps its dtype",
    "np.allclose(n, m)": r"write abs\(a - b\) <= 1e-8",
    "np.linspace(x, 0, 1)[0]": r"np.linspace may give another result in compiled code",
    "np.linalg.det(np.array([[x, y], [y, x]]))": r"np.det may give another result in compiled code",
    "np.where(p, np.float32(x), y)": "arithmetic of float32",
    "np.cos(p)": "np.cos of booleans",
    "list(map(abs, [n, m]))[0]": "map is not checked in compiled code",
    "hash(x)": "another result in compiled code",
    "p is True": "write ==",
    "len(range(x))": "range of float64",
}


@pytest.mark.filterwarnings("ignore:unsafe cast")  # of Numba, beside the refusal
@pytest.mark.parametrize("expression", REFUSED)
def test_numbers_that_would_differ_are_refused_with_their_line(expression: str) -> None:
    with pytest.raises(NotCompilable, match=REFUSED[expression]) as raised:
        in_functional_env(expression)
    assert raised.value.line
    assert raised.value.advice


MAX = {"max(n, p)": "max of a boolean and a number", "max(n)": "give two numbers or more"}


@pytest.mark.parametrize("expression", MAX)
def test_a_max_of_other_numbers_is_refused_by_the_checks_or_by_numba_itself(expression: str) -> None:
    of_numba = r"No implementation of function Function\(<built-in function max>\)"  # of 0.61
    with pytest.raises(NotCompilable, match=f"{MAX[expression]}|{of_numba}"):
        in_functional_env(expression)


NAN = {"x": math.nan, "y": math.nan}
LARGE = {"n": 2**63 - 1, "m": 2}


@pytest.mark.parametrize(
    ("expression", "rare"),
    [
        ("sum((n, m))", LARGE),
        ("sum([n, m])", LARGE),
        ("math.copysign(1.0, x)", NAN),
        ("x in (x, 1.0)", NAN),
        ("(x, 1) == (x, 1)", NAN),
    ],
)
@pytest.mark.parametrize("compile_it", [in_functional_env, in_ordinary_class])
def test_other_numbers_are_repeated_in_python_only_where_they_are_rare(
    compile_it: Any, expression: str, rare: Any
) -> None:
    compiled, python = compile_it(expression), in_python(expression)
    usual: dict[str, Any] = {"n": 1, "m": 2, "x": -0.5, "y": 1.5, "p": True, "q": False}
    assert bits(compiled(*usual.values())) == bits(python(*usual.values()))
    assert compiled(*{**usual, **rare}.values()) == FAILED


def test_a_bound_that_is_nan_is_repeated_in_python() -> None:
    compiled = in_functional_env("np.clip(np.array([x]), 1.0, y)[0]")
    assert compiled(1, 2, 7.0, 3.0, True, False) == 3.0
    assert compiled(1, 2, 7.0, math.nan, True, False) == FAILED


@pytest.mark.parametrize("expression", ["np.array([max(0, x), y])[0]", "np.full(2, max(0, x), np.float64)[0]",
                                        "sum((p, q))", "(n, m) in {(1, 2), (3, 4)}", "np.sort(np.array([n, m]))[0]",
                                        "-np.sin(max(0, x))", "np.array([n, p])[1]", "len([n, p])",
                                        "{n: m}.pop(n)", "{n: m}.pop(3, 4)"])  # fmt: skip
def test_numbers_of_known_types_are_compiled(expression: str) -> None:
    compiled, python = in_functional_env(expression), in_python(expression)
    for x in (-0.5, 0.0, 2.5):
        values = (1, 2, x, 1.5, True, False)
        assert bits(compiled(*values)) == bits(python(*values))


@pytest.mark.parametrize("compile_it", [in_functional_env, in_ordinary_class])
@pytest.mark.parametrize("expression", ["float(np.float32(x)) * float(np.float32(y))", "float(np.float32(x)) / 3.3",
                                        "float(n) + float(p)", "float('nan')"])  # fmt: skip
def test_float_makes_a_float_of_64_bits(compile_it: Any, expression: str) -> None:
    values = (2**53 + 1, 2, 0.1, 0.7, True, False)
    assert bits(compile_it(expression)(*values)) == bits(in_python(expression)(*values))


def test_a_key_that_a_dict_does_not_have_fails_as_in_python() -> None:
    compiled = in_functional_env("{1: m}.pop(n)")
    assert compiled(1, 2, 0.5, 1.5, True, False) == 2
    assert compiled(3, 2, 0.5, 1.5, True, False) == FAILED


def test_the_proof_takes_all_nan_as_equal() -> None:
    one, other = np.array([0.0, math.nan]), np.array([0.0, -math.nan])
    assert one.tobytes() != other.tobytes()
    assert _first("state", one, other, True) is None
    assert _first("state", one, np.array([-0.0, math.nan]), True) == ("state[0]", 0.0, -0.0)

"""Rare cases in which compiled code would compute other numbers: refused, or repeated in Python."""

import functools
import math
from typing import Any

import numpy as np
import pytest
from gymnasium import spaces

import qtab
from qtab.compilation import NotCompilable
from qtab.compilation.functional import compiled_env
from qtab.compilation.rewriting.library.clip_helpers import BOUND, NUMBER, VARIES, clip_number, winner
from support.lockstep.compiled_expressions import FAILED, bits, in_functional_env, in_ordinary_class, in_python

pytest.importorskip("numba")

BIG = 2**53 + 1
BOTH = pytest.mark.parametrize("compile_it", [in_functional_env, in_ordinary_class])


@functools.cache
def made(compile_it: Any, expression: str) -> Any:
    return compile_it(expression)


def outcome(compile_it: Any, expression: str, **given: Any) -> Any:
    """Returns the bits of compiled code, which must be those of Python; ``FAILED`` if the step is repeated."""
    compiled = made(compile_it, expression)
    values = {"n": 1, "m": 2, "x": 0.5, "y": 1.5, "p": True, "q": False, **given}
    result = compiled(*values.values())
    if result is FAILED:
        return FAILED
    assert bits(result) == bits(in_python(expression)(*values.values()))
    return bits(result)


@BOTH
@pytest.mark.parametrize("expression", ["min(n, x)", "max(x, n)", "max(n, x, y)", "(n if p else x)"])
def test_large_integers_beside_floats_are_not_rounded(compile_it: Any, expression: str) -> None:
    assert outcome(compile_it, expression, n=BIG, x=float(2**53)) == FAILED
    assert outcome(compile_it, expression, n=7) != FAILED


@BOTH
@pytest.mark.parametrize(
    "expression",
    ["(n, 1) == (x, 1)", "(n, m) != (x, m)", "n in (x, 1.0)", "x in (1, n)"],
)
def test_large_integers_in_tuples_are_compared_exactly(compile_it: Any, expression: str) -> None:
    assert outcome(compile_it, expression, n=BIG, x=float(2**53)) == FAILED
    assert outcome(compile_it, expression, n=7, x=7.0) != FAILED
    assert outcome(compile_it, expression, n=7, x=7.5) != FAILED


@pytest.mark.parametrize("expression", ["(n, 1) < (x, 1)", "x in [n, 1]", "((n, 1), 2) == ((x, 1), 2)"])
def test_nested_and_listed_integers_are_compared_exactly(expression: str) -> None:
    assert outcome(in_functional_env, expression, n=BIG, x=float(2**53)) == FAILED
    assert outcome(in_functional_env, expression, n=7, x=7.0) != FAILED


@BOTH
def test_large_constants_beside_floats_are_exact_or_refused(compile_it: Any) -> None:
    assert outcome(compile_it, "min(10**18, x)", x=5e18) == bits(10**18)
    assert outcome(compile_it, "x > 10**18", x=5e18) == bits(True)
    for expression in ("min(9223372036854775807, x)", "x > 9223372036854775807"):
        with pytest.raises(NotCompilable, match="the integer 9223372036854775807, which is used with floats") as raised:
            compile_it(expression)
        assert "such as 1e18 or math.inf" in raised.value.advice


@BOTH
@pytest.mark.parametrize(
    "expression", ["-max(0, x)", "-min(n, x)", "max(n, x) * -1", "max(0, x) % -2", "min(x, 0) // n"]
)
def test_the_sign_of_a_zero_that_may_be_an_integer_is_refused(compile_it: Any, expression: str) -> None:
    with pytest.raises(NotCompilable, match="sometimes an integer") as raised:
        compile_it(expression)
    assert "such as 0.0 for 0" in raised.value.advice
    assert raised.value.line


@pytest.mark.parametrize(
    "expression",
    [
        "-max((n, x))",
        "-sorted([max(0, x), y])[0]",
        "-([max(0, x)] + [y])[0]",
        "-[max(0, x), y][:1][0]",
        "-[one for one in (max(0, x), y)][0]",
        "-[one for _, one in enumerate([max(0, x), y])][0]",
        "-[one for one, _ in zip([max(0, x)], [y])][0]",
    ],
)
def test_containers_whose_numbers_are_not_followed_are_refused(expression: str) -> None:
    with pytest.raises(NotCompilable, match="sometimes an integer"):
        in_functional_env(expression)


@pytest.mark.parametrize(
    "expression", ["max(0, x) * 2", "max(0, x) / -7", "max(0, x) * y", "abs(min(0, x))", "max(0, x) - n"]
)
def test_other_operations_with_such_a_number_have_the_same_bits(expression: str) -> None:
    for x in (-1.0, -0.0, 0.0, 1.5):
        for y in (-1.5, -0.0):
            assert outcome(in_functional_env, expression, x=x, y=y) != FAILED


def test_the_sum_of_such_numbers_beyond_2_to_the_53_is_repeated() -> None:
    assert outcome(in_functional_env, "max(n, x) + m + m", n=2**53 - 3, m=5) == FAILED


@BOTH
@pytest.mark.parametrize("dtype", ["int8", "uint32"])
@pytest.mark.parametrize(
    "form", ["np.array([n, 1], np.{})[0]", "np.full(2, n, np.{})[1]", "np.full((2, 2), n, np.{})[1, 1]"]
)
def test_numbers_outside_a_narrow_dtype_do_not_wrap(compile_it: Any, dtype: str, form: str) -> None:
    expression = f"int({form.format(dtype)}) == m"
    for n in (0, 1, 100):
        assert outcome(compile_it, expression, n=n, m=n) != FAILED
    for n in (int(np.iinfo(dtype).max) + 1, int(np.iinfo(dtype).min) - 1):
        assert outcome(compile_it, expression, n=n) == FAILED


@pytest.mark.parametrize(
    "expression",
    ["np.full_like(np.zeros(2, np.int8), n)[0] == 1", "np.array(((n, 1), (1, 1)), np.uint8)[0, 0] == 1"],
)
def test_other_functions_that_make_narrow_arrays_are_checked_too(expression: str) -> None:
    assert outcome(in_functional_env, expression) != FAILED
    assert outcome(in_functional_env, expression, n=300) == FAILED


@BOTH
@pytest.mark.parametrize("expression", ["np.float32(n) < x", "np.array([n, 1], np.float32)[0] < np.float32(x)"])
def test_large_integers_are_not_rounded_twice_to_float32(compile_it: Any, expression: str) -> None:
    try:
        compile_it(expression)
    except NotCompilable:
        return
    assert outcome(compile_it, expression, n=2**60 + 2**36 + 1) == FAILED
    assert outcome(compile_it, expression, n=7) != FAILED


ZEROS = [(-0.0, 0.0, 1.0), (0.0, -0.0, 1.0), (0.0, -1.0, -0.0), (-0.0, -1.0, 0.0), (-5.0, 0.0, -0.0), (5.0, -0.0, 0.0)]


@pytest.mark.parametrize("form", ["np.clip(x, y, {})", "np.clip(np.array([x, x]), y, {})[1]",
                                  "np.clip(np.array([x, x]), np.array([y, y]), np.array([{0}, {0}]))[1]"])  # fmt: skip
@pytest.mark.parametrize("high", [1.0, 0.0, -0.0])
def test_clipped_zeros_have_the_sign_of_the_installed_numpy(form: str, high: float) -> None:
    expression = f"math.copysign(1.0, {form.format(f'({high} + 0 * m)')})"
    for value in (0.0, -0.0, 5.0, -5.0, math.nan):
        for low in (0.0, -0.0, -1.0):
            # The sign of a NaN is read in Python only.
            assert (outcome(in_ordinary_class, expression, x=value, y=low) == FAILED) == math.isnan(value)


def test_zeros_of_either_sign_in_clipped_arrays_of_functional_environments_are_repeated() -> None:
    expression = "np.clip(np.array([x, x]), 0.0, 1.0)[1]"
    assert outcome(in_functional_env, expression, x=-0.0) == FAILED
    assert outcome(in_functional_env, expression, x=0.0) != FAILED
    assert outcome(in_functional_env, expression, x=-3.0) != FAILED


@pytest.mark.parametrize("wins", [NUMBER, BOUND])
def test_numbers_are_clipped_alike_by_all_versions_but_for_zeros(wins: str) -> None:
    clip, varies = clip_number("h_one", wins), clip_number("h_other", VARIES)
    for value in (-2.0, 0.0, 0.5, 2.0, math.nan, math.inf):
        expected = float(np.clip(value, -1.0, 1.0))
        assert bits(clip(value, -1.0, 1.0)) == bits(varies(value, -1.0, 1.0)) == bits(expected)
    kept = math.copysign(1.0, clip(-0.0, 0.0, 1.0)) < 0
    assert kept == (wins == NUMBER)
    with pytest.raises(ValueError):
        varies(-0.0, 0.0, 1.0)
    assert winner(False) in (NUMBER, BOUND, VARIES)


class Walk(qtab.FunctionalEnv):
    """A state that is an integer at first."""

    observation_space = spaces.Box(-1e9, 1e9, (1,), np.float64)
    action_space = spaces.Discrete(2)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0

    def observe(self, state: Any) -> Any:
        return float(state)

    def bounded(self, x: Any) -> Any:
        return max(0, x)

    def opposite(self, x: Any) -> Any:
        return -x


class NegatesState(Walk):
    def transition(self, state: Any, action: Any, rng: np.random.Generator) -> Any:
        return state + 0.5 * action, -state, False


class NegatesResult(Walk):
    def transition(self, state: Any, action: Any, rng: np.random.Generator) -> Any:
        return state + 1, -self.bounded(state * 1.0), False


class NegatesArgument(Walk):
    def transition(self, state: Any, action: Any, rng: np.random.Generator) -> Any:
        return state + 1, self.opposite(max(0, state * 1.0)), False


class NegatesLaterState(Walk):
    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0.0

    def transition(self, state: Any, action: Any, rng: np.random.Generator) -> Any:
        return max(0, state - 1.0), -state, False


class AppendsAnInteger(Walk):
    def transition(self, state: Any, action: Any, rng: np.random.Generator) -> Any:
        numbers = [0.5 * state]
        numbers.append(action)
        return state + 1, -numbers[1], False


class AddsToState(Walk):
    def transition(self, state: Any, action: Any, rng: np.random.Generator) -> Any:
        return state + 0.5 * action, max(0, state) * 2, False


@pytest.mark.parametrize("cls", [NegatesState, NegatesResult, NegatesArgument, NegatesLaterState, AppendsAnInteger])
def test_numbers_of_two_types_are_followed_through_states_and_functions(cls: Any) -> None:
    with pytest.raises(NotCompilable, match="sometimes an integer"):
        compiled_env(cls())


def test_a_state_that_is_an_integer_at_first_is_compiled_where_it_makes_no_difference() -> None:
    settings: Any = {"discretizer": "bins", "bins": [5], "episodes": 20, "max_episode_steps": 20, "seed": 0}
    run = qtab.train(AddsToState(), algorithm="sarsa", backend="numba", **settings)
    plain = qtab.train(AddsToState(), algorithm="sarsa", backend="gymnasium", **settings)
    assert run.q_table.tobytes() == plain.q_table.tobytes()

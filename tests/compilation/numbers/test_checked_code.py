"""Compiled functions fail where Python raises errors, and what can differ from Python is refused before any run."""

import math
import random
from math import log as natural_logarithm
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces
from numpy.random import random as draw

import qtab
from qtab.compilation import NotCompilable
from qtab.compilation.functional import compiled_env
from qtab.compilation.interface.compiled_env import Stepper
from qtab.compilation.interface.qtab_env import FAILED

pytest.importorskip("numba")

NAMES = {"math": math, "np": np, "random": random, "ln": natural_logarithm, "draw": draw, "module": random}


class Base(qtab.FunctionalEnv):
    """An environment whose state is the number of actions 1 in a row. Random play does not reach 60."""

    observation_space: gym.Space[Any] = spaces.Box(0.0, 1.0, (1,), np.float64)
    action_space: gym.Space[Any] = spaces.Discrete(2)

    def __init__(self) -> None:
        self.values = np.zeros(2)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0

    def observe(self, state: Any) -> Any:
        return 0.5


def env_with(expression: str, folder: Any) -> Any:
    """Returns an environment whose reward is an expression of ``n`` and ``x``, which are 60 after 60 actions 1."""
    source = f"""def transition(self, state, action, rng):
    n = state + 1 if action == 1 else 0
    x = float(n)
    if n < 60:
        return n, 0.0, False
    return n, float({expression}), False
"""
    file = folder / "environment.py"
    file.write_text(source)
    scope: dict[str, Any] = dict(NAMES)
    exec(compile(source, str(file), "exec"), scope)  # noqa: S102 - the test's own text
    return type("Made", (Base,), {"transition": scope["transition"]})()


def after_sixty(env: Any) -> tuple[int, float]:
    """Returns the result and the reward of the sixtieth step."""
    compiled, parameters = compiled_env(env)
    stepper = Stepper(compiled, parameters.memory(), np.random.PCG64(0))
    assert stepper.reset() == 0
    for _ in range(59):
        assert stepper.step(1) == 0
    return stepper.step(1), float(stepper.reward[0])


RAISES = [
    "math.log(x - 60.0)",
    "ln(n - 60)",
    "math.log1p(x - 61.0)",
    "math.sqrt(-x)",
    "math.acos(x)",
    "math.sin(x * math.inf)",
    "math.exp(x * 100.0)",
    "int(x * math.nan)",
    "round(x * math.inf)",
    "math.floor(x * math.nan)",
    "math.ceil(x * math.inf)",
    "1 << (n - 61)",
    "1 >> (n - 61)",
    "rng.normal(0.0, -x)",
    "rng.normal(scale=-x)",
    "rng.normal(0.0, 1.0 if n < 60 else -x)",
    "rng.exponential(-x)",
    "rng.gamma(-x, 1.0)",
    "rng.weibull(-x)",
    "rng.lognormal(0.0, -x)",
    "rng.standard_t(-x)",
    "rng.triangular(x, 1.0, 2.0)",
    "rng.poisson(-x)",
    "rng.poisson(x * math.nan)",
    "rng.geometric(x)",
    "rng.binomial(5, x)",
    "rng.binomial(-n, 0.5)",
    "rng.uniform(0.0, x * math.inf)",
    "rng.integers(n, n)",
]


@pytest.mark.parametrize("expression", RAISES)
def test_the_step_fails_where_python_raises_an_error(expression: str, tmp_path: Any) -> None:
    env = env_with(expression, tmp_path)
    with pytest.raises((ValueError, OverflowError)):
        env.transition(59, 1, np.random.default_rng(0))
    assert after_sixty(env)[0] == FAILED


LARGE = [
    "1 << (n + 4)",
    "(n << 60) >> 60",
    "n * 2**60",
    "n * 2**58 + n * 2**58 - 1",
    "-(n * 2**56) - n * 2**57",
    "(n * 1000000) ** 3",
    "(n * 2**54 + 1) / 3",
    "int(x * 1e300)",
    "round(x * 1e300)",
    "math.floor(x * 1e300)",
    "math.floor(n * 2**54)",
    "np.uint8(n + 250)",
    "1.0 if n * 2**54 > 1e18 else 0.0",
    "-((n - 61) << 63)",
    "abs((n - 61) << 63)",
    "rng.uniform(0, n * 2**50 + 1)",
    "rng.uniform(low=-n * 2**50, high=1.0)",
    "rng.triangular(0, 1, n * 2**50 + 1)",
    "rng.noncentral_f(n * 2**50 + 1, 3, 2)",
    "rng.normal(n * 2**50 + 1, x)",
]


@pytest.mark.parametrize("expression", LARGE)
def test_integers_do_not_wrap(expression: str, tmp_path: Any) -> None:
    assert after_sixty(env_with(expression, tmp_path))[0] == FAILED


SAME = [
    "n**3 - 7 * n // 11 % 5",
    "(1 << 40) >> 3",
    "n / 7",
    "-n // -7",
    "-n % 7",
    "math.log(x) + math.log2(x) + math.log1p(x) + math.expm1(-x) + math.atan2(n, x)",
    "math.floor(-x / 7) + math.ceil(x / 7) + math.trunc(-x / 7) + round(x / 8) + int(-x / 7)",
    "rng.normal(1.0, x) + rng.gamma(x, 2.0) + rng.poisson(x / 60) + rng.uniform(-x, x) + rng.exponential(scale=x)",
    "rng.binomial(n, 0.25) + rng.geometric(0.5) + rng.integers(0, n)",
    "np.arange(n).sum() + np.sqrt(x)",
    "int(n > 1) + int(n > 2)",
    "(action == 1) - (action == 0)",
    "np.int64(np.int8(n)) * 100",
    "1.0 if np.int8(n) < 61 else 2.0",
    "1.0 if not np.int8(n) else 2.0",
    "1.0 if n > 59.5 else 2.0",
    "math.floor(n)",
    "math.floor(x * 2.0**53)",
    "abs(-n) + (1 >> (n + 10)) + ((n - 61) << 63)",
    "1.0 if np.float32(x) < 60.5 and np.uint64(n) == 60 else 2.0",
]


@pytest.mark.parametrize("expression", SAME)
def test_other_results_are_those_of_python(expression: str, tmp_path: Any) -> None:
    env = env_with(expression, tmp_path)
    _, reward, _ = env.transition(59, 1, np.random.Generator(np.random.PCG64(0)))
    assert after_sixty(env) == (0, reward)


REFUSED = {
    "max(np.int8(n), 0) + 200": "convert the numbers",
    "-(n > 1)": "write not x",
    "1.0 if ~(n > 1) else 2.0": "write not x",
    "x**2": "write products",
    "2**n": "write products",
    "x**0.5": "write products",
    "np.exp(x)": "write math.exp",
    "np.log(x)": "write math.log",
    "np.log1p(x)": "write math.log1p",
    "np.arctan2(x, 2.0)": "write math.atan2",
    "np.arcsin(x / 60)": "write math.asin",
    "np.cbrt(x)": "write it with functions of math",
    "math.gamma(x)": "use sin, cos",
    "math.lgamma(x)": "use sin, cos",
    "math.hypot(x, 1.0)": r"write math.sqrt\(x \* x \+ y \* y\)",
    "math.pow(x, 2.0)": "write products",
    "rng.wald(1.0, x)": "draw from another distribution",
    "rng.power(x)": "draw from another distribution",
    "np.sum(self.values)": "add in a loop",
    "self.values.sum()": "add in a loop",
    "self.values.mean()": "add in a loop",
    "np.dot(self.values, self.values)": "add in a loop",
    "sum((x, 2.0))": "add in a loop",
    "round(x, 2)": r"write math.floor\(x \+ 0.5\)",
    "np.int8(n) + np.int8(n)": "arithmetic of int8.*convert the numbers",
    "np.int32(n) * np.int32(n)": "arithmetic of int32.*convert the numbers",
    "np.uint64(n) + np.uint64(1)": "arithmetic of uint64.*convert the numbers",
    "np.float32(x) * 0.1": "float32 and wider numbers.*convert the numbers",
    "(n > 1) + (n > 2)": "arithmetic of booleans.*convert them",
    "draw()": "random does not draw from the generator.*draw from rng",
    "module.random()": "draw from rng",
}


@pytest.mark.parametrize("expression", REFUSED)
def test_what_can_differ_is_refused(expression: str, tmp_path: Any) -> None:
    with pytest.raises(NotCompilable, match=REFUSED[expression]) as caught:
        compiled_env(env_with(expression, tmp_path))
    assert caught.value.file == str(tmp_path / "environment.py")
    assert caught.value.line == 6
    assert expression in caught.value.reason


class Helper(Base):
    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return state, self.logarithm(float(state)), False

    def logarithm(self, x: float) -> float:
        return np.exp(x)


def test_methods_are_checked() -> None:
    with pytest.raises(NotCompilable, match=r"np.exp rounds differently .*write math.exp"):
        compiled_env(Helper())


class FillsDiagonal(Base):
    def __init__(self) -> None:
        self.values = np.zeros((2, 2))

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        np.fill_diagonal(self.values, 1.0)
        return state, self.values[0, 0], False


class AssignsToFlat(FillsDiagonal):
    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        self.values.flat[0] = 1.0
        return state, self.values[0, 0], False


class Shuffles(FillsDiagonal):
    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        rng.shuffle(self.values)
        return state, self.values[0, 0], False


@pytest.mark.parametrize("made", [FillsDiagonal, AssignsToFlat, Shuffles])
def test_arrays_of_the_environment_are_not_changed(made: Any) -> None:
    with pytest.raises(NotCompilable, match="chang"):
        compiled_env(made())


class ReadsAProperty(FillsDiagonal):
    @property
    def bonus(self) -> float:
        return float(self.values[0, 0])

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return state, self.bonus, False


def test_properties_are_refused() -> None:
    with pytest.raises(NotCompilable, match=r"self.bonus is a property.*write a method"):
        compiled_env(ReadsAProperty())


class CatchesErrors(Base):
    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        try:
            return state * 2**62, 0.0, False
        except Exception:
            return 0, 0.0, False


def test_errors_are_not_caught() -> None:
    with pytest.raises(NotCompilable, match=r"try: cannot be compiled; write the condition with if"):
        compiled_env(CatchesErrors())

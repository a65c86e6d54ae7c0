"""Draws with arguments that NumPy does not allow raise an error in compiled code too."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils import seeding

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.lockstep.rewriting import assert_nothing_refused, compiled_with_checks

CALLS = {
    "normal": "normal(0.0, self.x)",
    "exponential": "exponential(self.x)",
    "gamma": "gamma(self.x, 1.0)",
    "gamma with a scale": "gamma(2.0, scale=self.x)",
    "beta": "beta(self.x, 2.0)",
    "chisquare": "chisquare(self.x)",
    "standard_t": "standard_t(self.x)",
    "laplace": "laplace(0.0, self.x)",
    "logistic": "logistic(0.0, self.x)",
    "lognormal": "lognormal(0.0, self.x)",
    "weibull": "weibull(self.x)",
    "pareto": "pareto(self.x)",
    "rayleigh": "rayleigh(self.x)",
    "poisson": "poisson(self.x)",
    "binomial": "binomial(5, self.x)",
    "binomial with a count": "binomial(int(2.0 * self.x), 0.5)",
    "geometric": "geometric(self.x)",
    "uniform": "uniform(0.0, self.x)",
    "uniform to infinity": "uniform(0.0, 1.0 if self.x < 1.5 else math.inf)",
    "triangular": "triangular(0.0, self.x, 1.0)",
    "f": "f(self.x, 2.0)",
    "zipf": "zipf(self.x)",
}
SOURCE = """
import math

import gymnasium as gym


class Draws(gym.Env):
    action_space = gym.spaces.Discrete(7)
    observation_space = gym.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.x = 0.5
        return 0, {}

    def step(self, action):
        self.x = 0.5 * action - 1.0
        return 0, float(self.np_random.DRAW), False, False, {}
"""


def made(tmp_path: Any, call: str) -> gym.Env:
    path = tmp_path / "draws.py"
    path.write_text(SOURCE.replace("DRAW", call), encoding="utf-8")
    namespace: dict[str, Any] = {"__name__": "draws"}
    exec(compile(path.read_text(encoding="utf-8"), str(path), "exec"), namespace)  # noqa: S102
    env: gym.Env = namespace["Draws"]()
    return env


def outcome(step: Any, seed: int) -> tuple[Any, str]:
    rng, _ = seeding.np_random(seed)
    try:
        return step(rng), str(rng.bit_generator.state)
    except (ValueError, OverflowError):
        return "error", ""


@pytest.mark.parametrize("name", CALLS)
def test_an_invalid_argument_raises_an_error(name: str, tmp_path: Any) -> None:
    pytest.importorskip("numba")
    env: Any = made(tmp_path, CALLS[name])
    rewritten = rewrite(env)
    compiled = compiled_with_checks(rewritten)
    errors = 0
    for action in range(7):

        def in_python(rng: np.random.Generator, action: int = action) -> float:
            env.np_random = rng
            return float(env.step(action)[1])

        record = rewritten.initial.copy()[0]
        expected = outcome(in_python, action)
        for one in (rewritten, compiled):
            found = outcome(lambda rng, one=one, at=(record, action): float(one.step(*at, rng)[1]), action)
            assert found == expected, (action, one)
        errors += expected[0] == "error"
    assert 0 < errors < 7
    assert_nothing_refused()


@pytest.mark.parametrize("call", ["normal(0.0, -1.0)", "geometric(2.0)", "uniform(0.0, -1.0)", "binomial(5, 1.5)"])
def test_an_invalid_constant_is_refused(call: str, tmp_path: Any) -> None:
    with pytest.raises(NotCompilable, match="arguments that NumPy does not allow"):
        rewrite(made(tmp_path, call))

"""A step that fails in compiled code is repeated in Python, so that the user sees the error of the user's own line."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces

import qtab
from qtab.compilation.functional import compiled_env
from qtab.compilation.interface.compiled_env import Stepper
from qtab.compilation.interface.qtab_env import FAILED
from support.environments.own import Gambler, TicTacToe

pytest.importorskip("numba")


class Fails(qtab.FunctionalEnv):
    """Counts up, and fails in one of several ways at 5."""

    observation_space: gym.Space[Any] = spaces.Box(0.0, 10.0, (1,))
    action_space: gym.Space[Any] = spaces.Discrete(2)

    def __init__(self, way: int = 0) -> None:
        self.way = way
        self.table = np.arange(6.0)

    def initial_state(self, rng: np.random.Generator) -> Any:
        if self.way == 5:
            raise RuntimeError("no first state")
        return 0

    def transition(self, state: int, action: int, rng: np.random.Generator) -> Any:
        state += 1
        if state == 5:
            if self.way == 1:
                raise KeyError("the fifth step")
            if self.way == 2:
                return state, 1.0 / (state - 5), False
            if self.way == 3:
                return state, self.table[state + action + 1], False
        return state, 0.0, False

    def observe(self, state: int) -> Any:
        if state == 5 and self.way == 4:
            return float("nan")
        return float(state)


WAYS: list[tuple[int, type[Exception], str]] = [
    (1, KeyError, "the fifth step"),
    (2, ZeroDivisionError, "division by zero"),
    (3, IndexError, "index 7 is out of bounds"),
    (4, ValueError, "observe of Fails must return an element of Box"),
]


@pytest.mark.parametrize(("way", "error", "message"), WAYS, ids=[error.__name__ for _, error, _ in WAYS])
def test_the_error_is_raised_in_python(way: int, error: type[Exception], message: str) -> None:
    env = Fails(way)
    compiled, parameters = compiled_env(env)
    stepper = Stepper(compiled, parameters.memory(), np.random.PCG64(0))
    stepper.reset()
    for _ in range(4):
        assert stepper.step(1) == 0
    before = stepper.state.tobytes()
    assert stepper.step(1) == FAILED
    assert stepper.state.tobytes() == before
    with pytest.raises(error, match=message):
        env.__qtab_env_failed__(before, 1, np.random.default_rng(0))


def test_a_reset_that_fails() -> None:
    env = Fails(5)
    compiled, parameters = compiled_env(Fails(0))
    assert Stepper(compiled, qtab_memory(env, parameters), np.random.PCG64(0)).reset() == FAILED
    with pytest.raises(RuntimeError, match="no first state"):
        env.__qtab_env_failed__(None, None, np.random.default_rng(0))


def qtab_memory(env: Any, parameters: Any) -> Any:
    """The parameters of another environment of the class."""
    return type(parameters)({name: getattr(env, name) for name in parameters.values}).memory()


@pytest.mark.parametrize("made", [TicTacToe, Gambler])
def test_an_action_that_the_mask_leaves_out_fails(made: Any) -> None:
    env = made()
    compiled, parameters = compiled_env(env)
    stepper = Stepper(compiled, parameters.memory(), np.random.PCG64(0))
    stepper.reset()
    stepper.step(0)
    while stepper.action_mask.all():
        stepper.reset()
        stepper.step(0)
    taken = int(np.flatnonzero(stepper.action_mask == 0)[0])
    assert stepper.step(taken) == FAILED
    with pytest.raises(ValueError, match=r"the square is taken|the stake exceeds the capital"):
        env.__qtab_env_failed__(stepper.state.tobytes(), taken, np.random.default_rng(0))


def test_a_step_that_does_not_fail_in_python_is_reported() -> None:
    env = Fails()
    compiled, parameters = compiled_env(env)
    stepper = Stepper(compiled, parameters.memory(), np.random.PCG64(0))
    stepper.reset()
    with pytest.raises(RuntimeError, match="Fails failed in compiled code, but not in Python"):
        env.__qtab_env_failed__(stepper.state.tobytes(), 1, np.random.default_rng(0))

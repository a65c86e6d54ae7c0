"""Observations of functional environments: converted to their space, or refused."""

import re
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces

import qtab


class Observed(qtab.FunctionalEnv):
    """Has a single observation."""

    action_space = spaces.Discrete(2)

    def __init__(self, space: Any, observation: Any) -> None:
        self.observation_space, self.observation = space, observation

    def initial_state(self, rng: np.random.Generator) -> int:
        return 0

    def transition(self, state: int, action: int, rng: np.random.Generator) -> tuple[int, float, bool]:
        return state, 0.0, False

    def observe(self, state: int) -> Any:
        return self.observation


BOX = spaces.Box(-1.0, 1.0, (2,))
OBSERVATIONS: list[tuple[gym.Space[Any], Any, Any]] = [
    (BOX, (0.1, -1), np.array([0.1, -1.0], np.float32)),
    (BOX, [np.float32(0.1), 0], np.array([0.1, 0.0], np.float32)),
    (spaces.Box(-1.0, 1.0, (1,), np.float64), 0.5, np.array([0.5])),
    (spaces.Box(0, 255, (2, 2), np.uint8), ((1, 2), (3, 4)), np.array([[1, 2], [3, 4]], np.uint8)),
    (spaces.Discrete(3, start=-1), np.int64(-1), -1),
    (spaces.Discrete(2), np.bool_(True), 1),
    (spaces.MultiDiscrete([3, 2]), (2, True), np.array([2, 1])),
    (spaces.MultiBinary(2), (True, False), np.array([1, 0], np.int8)),
    (spaces.Tuple((spaces.Discrete(2), BOX)), (1, (0, 0)), (1, np.zeros(2, np.float32))),
    (spaces.Dict(a=BOX, b=spaces.Discrete(3)), {"b": 2, "a": (0, 0)}, {"a": np.zeros(2, np.float32), "b": 2}),
    (spaces.Dict(a=BOX, b=spaces.Discrete(3)), ((0, 0), 2), {"a": np.zeros(2, np.float32), "b": 2}),
    (spaces.Text(3), "abc", "abc"),
]


@pytest.mark.parametrize(("space", "given", "expected"), OBSERVATIONS, ids=[str(space) for space, *_ in OBSERVATIONS])
def test_observations_are_converted_to_the_space(space: Any, given: Any, expected: Any) -> None:
    observation, _ = Observed(space, given).reset(seed=0)
    assert observation in space
    assert repr(observation) == repr(expected)


OUTSIDE: list[tuple[gym.Space[Any], Any, str]] = [
    (BOX, (0.1, 1.5), "must return an element of Box"),
    (BOX, (0.1, float("nan")), "must return an element of Box"),
    (BOX, (0.1, 0.1, 0.1), r"must return an array of shape \(2,\), the observation space's, got one of \(3,\)"),
    (BOX, ("a", "b"), "must return numbers in an array, a tuple or a list, got"),
    (BOX, {"a": 1}, "must return numbers in an array, a tuple or a list, got"),
    (spaces.Box(0, 255, (1,), np.uint8), (300,), "must return an element of Box"),
    (spaces.MultiDiscrete([3, 2]), (2.5, 1), "must return integers in an array, a tuple or a list, got"),
    (spaces.MultiDiscrete([3, 2]), (3, 1), "must return an element of MultiDiscrete"),
    (spaces.Tuple((BOX, BOX)), (1, 2, 3), "must return a tuple of 2 parts, got"),
    (spaces.Tuple((BOX, spaces.Discrete(2))), ((0, 0), 2), r"part 1, must return an element of Discrete\(2\), got 2"),
    (spaces.Dict(a=BOX), {"b": 1}, r"must return the keys \['a'\], got \['b'\]"),
    (spaces.Text(3), "abcd", "must return an element of Text"),
]


@pytest.mark.parametrize(("space", "given", "message"), OUTSIDE, ids=[message for *_, message in OUTSIDE])
def test_observations_outside_the_space_are_refused(space: Any, given: Any, message: str) -> None:
    env = Observed(space, given)
    with pytest.raises((TypeError, ValueError), match=re.escape("observe of Observed") + ".*" + message):
        env.reset(seed=0)

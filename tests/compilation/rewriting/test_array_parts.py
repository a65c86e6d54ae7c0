"""Parts of arrays that are assigned, ``divmod`` and options with defaults, as classes on the internet have them."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.environments.marked import marked_line
from support.lockstep.rewriting import assert_equal_steps, assert_nothing_refused, compiled_with_checks


class Board(gym.Env):
    """Assigns tuples and lists to parts of arrays, and splits a number by ``divmod``."""

    observation_space = gym.spaces.Discrete(12)
    action_space = gym.spaces.Discrete(3)
    PLACES = (2, 0, 1)

    def __init__(self):
        self.grid = np.zeros((4, 3), np.int8)
        self.places, self.weights = np.zeros(3, np.int64), np.zeros(2, np.float32)
        self.lights = np.zeros((2, 2), bool)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        options = options or {}
        self.grid[:, :] = 0
        self.lights[:,] = False
        self.places[:] = self.PLACES
        self.weights[:] = 1, 0.5
        self.cell = options.get("cell", int(self.np_random.integers(3)))
        return self.cell, {"bits": bin(self.cell).count("1")}

    def step(self, action):
        self.cell = (5 * self.cell + int(self.np_random.integers(12))) % 12
        row, column = divmod(self.cell, 3)
        self.grid[row] = column, -action, 1
        self.grid[1:, 2] = [self.cell, action, 3]
        self.places[:2] = self.places[1], self.places[0] + divmod(-self.cell, action + 1)[1]
        self.weights[:] = (self.cell / 3, action)
        self.lights[1] = (action, self.cell % 2 == 0)
        corner = int(self.grid[divmod(self.cell, 3)])
        reward = 0.5 * corner + float(self.weights[0]) + float(self.lights[1, 0])
        return self.cell, reward, self.cell == 11, False, {}


def test_parts_of_arrays_are_assigned() -> None:
    assert assert_equal_steps(Board(), rewrite(Board()), 500, 3)


class AddsInReset(ExtraEnv):
    def __init__(self):
        super().__init__()
        self.grid = np.zeros((2, 2))

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        self.grid[:, :] += 1.0
        self.board[:] += 1.0  # after the base class has set it
        return self.cell, {}

    def extra(self) -> Any:
        return float(self.board[0] + self.grid[0, 0])


def test_a_whole_array_that_a_reset_changes_keeps_its_values() -> None:
    assert rewrite(AddsInReset()).kept_between_episodes == ("grid",)


@pytest.mark.slow
def test_compiled_they_are_equal() -> None:
    pytest.importorskip("numba")
    assert_equal_steps(Board(), compiled_with_checks(rewrite(Board())), 500, 3)
    assert_nothing_refused()


class EmptyIndex(ExtraEnv):
    def extra(self) -> Any:
        self.board[()] = 1.0  # here
        return 0.0


class OtherLength(ExtraEnv):
    def extra(self) -> Any:
        self.board[:] = 1.0, 2.0  # here
        return 0.0


class UnknownLength(ExtraEnv):
    def extra(self) -> Any:
        self.board[self.cell :] += 1.0  # here
        return 0.0


class DivmodOfFloats(ExtraEnv):
    def extra(self) -> Any:
        return divmod(0.5 * self.cell, 2.0)[1]  # here


class DivmodOfDraws(ExtraEnv):
    def extra(self) -> Any:
        return float(divmod(self.np_random.integers(7), 2)[1])  # here


class DefaultBesideKey(ExtraEnv):
    def extra(self) -> Any:
        return {"a": 1.0}.get("a", self.board[self.cell])  # here: Python raises IndexError


class PermutationOfArray(ExtraEnv):
    def extra(self) -> Any:
        self.board[:] = self.np_random.permutation(self.board)  # here
        return 0.0


REFUSALS = {
    EmptyIndex: "an empty index of an array .*write array\\[:\\]",
    OtherLength: "an array of float64 with shape \\(2,\\) assigned to a part .*same dtype and shape",
    UnknownLength: "a part of an array whose size is not known is changed in place .*write a loop",
    DivmodOfFloats: "divmod of something other than two integers .*write x // y and x % y",
    DivmodOfDraws: "a call whose result is used several times .*assign it to a variable first",
    DefaultBesideKey: "the method get of a dict .*or an index in",
    PermutationOfArray: "permutation of an array .*draw the indices with permutation\\(n\\)",
}


@pytest.mark.parametrize("cls", REFUSALS, ids=lambda cls: cls.__name__)
def test_others_are_refused_with_their_line(cls: Any) -> None:
    with pytest.raises(NotCompilable, match=REFUSALS[cls]) as caught:
        rewrite(cls())
    assert caught.value.line == marked_line(cls)

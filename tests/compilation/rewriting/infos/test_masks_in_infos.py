"""Action masks in info dicts: one that depends on where or when the dict is made is refused with its line."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces

from qtab.compilation.rewriting import rewrite
from support.environments.marked import marked_line


class Masked(gym.Env):
    """Has a mask in each info dict, beside another item."""

    observation_space = spaces.Discrete(10)
    action_space = spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        return self.cell, {"action_mask": np.array([True, self.cell < 5])}

    def move(self):
        self.cell = 1
        return 0.0

    def step(self, action):
        self.cell = (self.cell + action) % 10
        info = {"action_mask": np.array([True, self.cell < 5]), "cell": self.cell}
        return self.cell, 0.0, False, False, info


class OtherMaskFirst(Masked):
    def step(self, action):
        self.cell = (self.cell + action) % 10
        if self.cell > 5:
            return self.cell, 0.0, False, False, {"action_mask": np.array([True, False])}  # here
        return self.cell, 0.0, False, False, {"action_mask": np.array([True, self.cell < 5])}


class NoMaskFirst(Masked):
    def step(self, action):
        self.cell = (self.cell + action) % 10
        if self.cell > 5:
            return self.cell, 0.0, False, False, {}  # here
        return self.cell, 0.0, False, False, {"action_mask": np.array([True, self.cell < 5])}


class OtherDtypeFirst(Masked):
    def step(self, action):
        self.cell = (self.cell + action) % 10
        if self.cell > 5:
            return self.cell, 0.0, False, False, {"action_mask": np.array([1.0, 0.5])}  # here
        return self.cell, 0.0, False, False, {"action_mask": np.array([True, self.cell < 5])}


class Updates(Masked):
    def step(self, action):
        self.cell = (self.cell + action) % 10
        info = {"action_mask": np.array([True, self.cell < 5])}
        if self.cell > 5:
            info.update({"action_mask": np.array([True, False])})  # here
        return self.cell, 0.0, False, False, info


class ChangesLater(Masked):
    def step(self, action):
        self.cell = (self.cell + action) % 10
        info = {"action_mask": np.array([True, self.cell < 5])}  # here
        if self.cell > 5:
            self.cell = 1
        return self.cell, 0.0, False, False, info


class ChangesInReturn(Masked):
    def step(self, action):
        self.cell = (self.cell + action) % 10
        info = {"action_mask": np.array([True, self.cell < 5])}
        return self.cell, self.move(), False, False, info  # here


class PassesOn(NoMaskFirst):
    def step(self, action):
        observation, reward, terminated, truncated, info = super().step(action)  # here
        return observation, reward, terminated, truncated, info


REFUSED = [OtherMaskFirst, NoMaskFirst, OtherDtypeFirst, Updates, ChangesLater, ChangesInReturn, PassesOn]


@pytest.mark.parametrize("cls", REFUSED, ids=lambda cls: cls.__name__)
def test_masks_that_depend_on_where_the_info_dict_is_made_are_refused(cls: Any) -> None:
    refusal = rewrite(cls()).mask_refusal
    assert refusal is not None
    assert refusal.line == marked_line(cls)
    assert "the action mask" in refusal.reason
    assert refusal.advice == "write a method action_masks(self)"


def test_one_mask_beside_other_items_is_compiled() -> None:
    env = Masked()
    rewritten = rewrite(env)
    assert rewritten.action_mask is not None
    record, rng = rewritten.initial.copy()[0], np.random.default_rng(0)
    rewritten.reset(record, rng)
    env.reset(seed=0)
    for _ in range(9):
        rewritten.step(record, 1, rng)
        assert rewritten.action_mask(record).tolist() == env.step(1)[4]["action_mask"].tolist()

"""Numbers that are counted in an info dict: left out, unless the change may show elsewhere."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.environments.marked import marked_line
from support.lockstep.rewriting import assert_equal_steps


class Counts(ExtraEnv):
    def __init__(self):
        super().__init__()
        self.total = np.zeros(2)

    def reset(self, *, seed=None, options=None):
        gym.Env.reset(self, seed=seed)
        self.cell, self.total[:] = 0, 0.0
        info = {"falls": 1}
        info["falls"] -= 1
        return self.cell, info

    def step(self, action):
        self.cell = (self.cell + action) % 10
        info: Any = {"falls": 0, "speed": 1.5, "total": self.total}
        if self.cell > 4:
            info["falls"] += 1
        info["speed"] *= self.cell
        return self.cell, float(self.total[0]), False, False, info


def test_numbers_in_info_dicts_may_be_counted() -> None:
    assert_equal_steps(Counts(), rewrite(Counts()), 60, 3)


class Array(Counts):
    def step(self, action):
        info: Any = {"falls": self.total}
        info["falls"] += 1  # here
        return self.cell, float(self.total[0]), False, False, info


class Later(Counts):
    def step(self, action):
        info: Any = {"falls": 0}
        info["falls"] = self.total
        info["falls"] += 1  # here
        return self.cell, float(self.total[0]), False, False, info


class Updated(Counts):
    def step(self, action):
        info: Any = {"falls": 0}
        info.update({"falls": self.total})
        info["falls"] += 1  # here
        return self.cell, float(self.total[0]), False, False, info


class ByKey(Counts):
    def step(self, action):
        info: Any = {"falls": 0}
        key = "falls"
        info[key] = self.total
        info["falls"] += 1  # here
        return self.cell, float(self.total[0]), False, False, info


class ByOtherName(Counts):
    def step(self, action):
        info: Any = {"falls": 0}
        other = info
        other["falls"] = self.total
        info["falls"] += 1  # here
        return self.cell, float(self.total[0]), False, False, info


class ByMethod(Counts):
    def put(self, info):
        info["falls"] = self.total

    def step(self, action):
        info: Any = {"falls": 0}
        self.put(info)
        info["falls"] += 1  # here
        return self.cell, float(self.total[0]), False, False, info


class ByAnnotation(Counts):
    def step(self, action):
        info: Any = {"falls": 0}
        info["falls"]: Any = self.total  # type: ignore[misc]
        info["falls"] += 1  # here
        return self.cell, float(self.total[0]), False, False, info


class Unpacked(Counts):
    def step(self, action):
        info: Any = {"falls": 0, **{"falls": self.total}}
        info["falls"] += 1  # here
        return self.cell, float(self.total[0]), False, False, info


class Missing(Counts):
    def step(self, action):
        info: Any = {}
        info["falls"] += 1  # here
        return self.cell, float(self.total[0]), False, False, info


class OfBase(Counts):
    def step(self, action):
        observation, reward, terminated, truncated, info = super().step(action)
        info["falls"] += 1  # here
        return observation, reward, terminated, truncated, info


class Mask(Counts):
    def step(self, action):
        info: Any = {"action_mask": 0}
        info["action_mask"] += 1  # here
        return self.cell, float(self.total[0]), False, False, info


class Draws(Counts):
    def step(self, action):
        info: Any = {"falls": 0}
        info["falls"] += self.np_random.random()  # here
        return self.cell, float(self.total[0]), False, False, info


REFUSED = [
    *(Array, Later, Updated, ByKey, ByOtherName, ByMethod, ByAnnotation, Unpacked, Missing, OfBase, Mask, Draws),
]


@pytest.mark.parametrize("cls", REFUSED, ids=lambda cls: cls.__name__)
def test_others_are_refused(cls: type[ExtraEnv]) -> None:
    with pytest.raises(NotCompilable, match=r"changed by an operator|draws|whose effects are unknown") as caught:
        rewrite(cls())
    assert caught.value.line == marked_line(cls)

"""Info dicts that a step changes, and that it has not made: other code reads them, so that they are refused."""

from typing import Any

import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.environments.marked import marked_line

TOTALS = {"steps": 0}


class OfModule(ExtraEnv):
    def step(self, action):
        info = TOTALS  # here
        if self.cell > 5:
            info["steps"] = 1
        return self.cell, float(TOTALS["steps"]), False, False, info


class OfObject(ExtraEnv):
    def __init__(self):
        super().__init__()
        self.totals = {"steps": 0}

    def step(self, action):
        info = self.totals  # here
        if self.cell > 5:
            info.update({"steps": 1})
        return self.cell, float(self.totals["steps"]), False, False, info


class OfHelper(ExtraEnv):
    def totals(self):
        return TOTALS

    def step(self, action):
        cell, reward, terminated, truncated, info = super().step(action)
        info = self.totals()  # here
        info["steps"] = self.cell
        return cell, reward, terminated, truncated, info


class ByOtherName(ExtraEnv):
    def step(self, action):
        info = TOTALS  # here
        other = info
        if self.cell > 5:
            other["steps"] = 1
        return self.cell, float(TOTALS["steps"]), False, False, info


class InHelper(ExtraEnv):
    def fill(self, info):
        if self.cell > 5:
            info["steps"] = 1

    def step(self, action):
        info = TOTALS  # here
        self.fill(info)
        return self.cell, float(TOTALS["steps"]), False, False, info


class OfStaticMethodNamedCopy(ExtraEnv):
    @staticmethod
    def copy():
        return TOTALS

    def step(self, action):
        info = self.copy()  # here
        info["steps"] = 1
        return self.cell, float(TOTALS["steps"]), False, False, info


class OfMethodNamedCopy(ExtraEnv):
    def copy(self):
        return TOTALS

    def step(self, action):
        info = self.copy()  # here
        info["steps"] = 1
        return self.cell, float(TOTALS["steps"]), False, False, info


class OfMethodOfBase(OfMethodNamedCopy):
    def step(self, action):
        info = OfMethodNamedCopy.copy(self)  # here
        info["steps"] = 1
        return self.cell, float(TOTALS["steps"]), False, False, info


class OfBaseByIndex(ExtraEnv):
    def step(self, action):
        given = super().step(action)[4]  # here
        given["cell"] = self.cell
        return self.cell, 0.0, False, False, {}


class Shared(ExtraEnv):
    def step(self, action):
        return self.cell, float(TOTALS["steps"]), False, False, TOTALS  # here


class OfBase(Shared):
    def step(self, action):
        cell, reward, terminated, truncated, info = super().step(action)
        info["cell"] = self.cell
        return cell, reward, terminated, truncated, info


class Own(ExtraEnv):
    def totals(self, **more):
        made = dict(TOTALS)
        made.update(more)
        return made

    def step(self, action):
        cell, reward, terminated, truncated, info = super().step(action)
        info["cell"] = self.cell
        if self.cell > 5:
            info = self.totals()
            info.update(cell=self.cell)
        else:
            info = TOTALS.copy()
        return cell, reward, terminated, truncated, info


def refusal(cls: Any) -> NotCompilable:
    with pytest.raises(NotCompilable, match="an info dict is changed") as caught:
        rewrite(cls())
    return caught.value


CHANGED = [
    *(OfModule, OfObject, OfHelper, ByOtherName, InHelper, OfStaticMethodNamedCopy, OfMethodNamedCopy, OfMethodOfBase),
    OfBaseByIndex,
]


@pytest.mark.parametrize("cls", CHANGED, ids=lambda cls: cls.__name__)
def test_dicts_of_others_are_not_changed(cls: Any) -> None:
    assert refusal(cls).line == marked_line(cls)


def test_nor_those_that_a_base_class_returns() -> None:
    assert "`TOTALS` was not made here" in refusal(OfBase).reason


@pytest.mark.parametrize("cls", [Shared, Own], ids=lambda cls: cls.__name__)
def test_dicts_that_are_made_here_or_not_changed_are_left_out(cls: Any) -> None:
    assert rewrite(cls()).source
    assert TOTALS == {"steps": 0}


class ChangesElementInPlace(ExtraEnv):
    def step(self, action):
        info = {"board": self.board}
        info["board"] += 1.0
        return self.cell, float(self.board[0]), False, False, info


def test_elements_that_are_changed_in_place_are_refused() -> None:
    with pytest.raises(
        NotCompilable, match=r"an element of an info dict is changed by an operator.*with the new value"
    ):
        rewrite(ChangesElementInPlace())

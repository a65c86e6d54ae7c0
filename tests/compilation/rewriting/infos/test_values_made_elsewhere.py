"""Info dicts whose code changes a value that only seems to be made there: they are refused, as they are left out."""

from typing import Any

import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.lockstep.rewriting import assert_equal_steps


class Shows(ExtraEnv):
    def reset(self, *, seed=None, options=None):
        self.left, self.right, self.grid = np.zeros(3), np.zeros(3), np.ones((2, 3))
        return super().reset(seed=seed)

    def pair(self):
        return [self.left, self.right]

    def made(self, rows=None):
        if rows is None:
            rows = np.zeros(3)
        return rows

    def count(self):
        self.left[0] += 1.0
        return self.left

    def shown(self) -> Any:
        return {}

    def step(self, action):
        observation, reward, terminated, truncated, _ = super().step(action)
        return observation, reward + self.left[0] + self.right[0], terminated, truncated, self.shown()


class UnpacksResult(Shows):
    def shown(self):
        _, right = self.pair()
        right[0] = 5.0
        return {}


class UnpacksCopy(Shows):
    def shown(self):
        _, right = [self.left, self.right].copy()
        right[0] = 5.0
        return {}


class TakesDefault(Shows):
    def shown(self):
        mine = self.made(self.left)
        mine[0] = 4.0
        return {}


class CountsItself(Shows):
    def shown(self):
        number = self.count()
        number += 1.0
        return {}


class SumsFromStart(Shows):
    def shown(self):
        total = sum([], self.left)
        total += 1.0
        return {}


class CallsUnwrapped(Shows):
    def shown(self):
        return {"count": self.unwrapped.count()[0]}  # type: ignore[attr-defined]


class Matches(Shows):
    def shown(self):
        rows = np.zeros(3)
        match [self.left]:
            case [rows]:
                pass
        rows[0] = 5.0
        return {}


class ChangesNumPy(Shows):
    def shown(self):
        np.seterr(all="ignore")
        return {}


class CountsInObjects(Shows):
    def shown(self):
        rows = np.zeros(3, object)
        rows[0] = self.left
        rows[0] += 1.0
        return {}


class TakesPart(Shows):
    def shown(self):
        part = self.left[None]
        part += 1.0
        return {}


class TakesGreatest(Shows):
    def shown(self):
        greatest = max([self.left])
        greatest += 1.0
        return {}


class SumsInto(Shows):
    def shown(self):
        return {"sum": self.grid.sum(axis=0, out=self.left)}


class SumsIntoByPosition(Shows):
    def shown(self):
        return {"sum": self.grid.sum(0, None, self.left)}


class RoundsInto(Shows):
    def shown(self):
        return {"rounded": self.right.round(0, self.left)}


class TakesObject(Shows):
    def __init__(self):
        super().__init__()
        self.objects = np.array([None, None], object)

    def shown(self):
        taken = self.objects[0]
        taken += 1.0
        return {}


class PassesOn(Shows):
    def __init__(self):
        super().__init__()
        self.cells = []

    def shown(self):
        return {"added": list(map(self.cells.append, (1, 2)))}


CHANGES = [
    *(SumsInto, SumsIntoByPosition, RoundsInto, TakesObject),
    *(CountsInObjects, TakesPart, TakesGreatest, PassesOn),
    *(UnpacksResult, UnpacksCopy, TakesDefault, CountsItself, SumsFromStart, CallsUnwrapped, Matches, ChangesNumPy),
]


@pytest.mark.parametrize("cls", CHANGES, ids=lambda cls: cls.__name__)
def test_changes_of_values_that_are_made_elsewhere_are_refused(cls: Any) -> None:
    with pytest.raises(NotCompilable):
        rewrite(cls())


class ShowsNumbers(Shows):
    """Changes only numbers and what its method makes, and reads numbers with the names of methods."""

    def __init__(self):
        super().__init__()
        self.fill, self.pop, self.place = 0.5, 3, (1, 2)

    def shown(self):
        counts, speed = np.zeros(3, int), np.linalg.norm(self.left)
        for i in range(3):
            counts[i] += 1
        row, column = divmod(self.cell, 3)
        x, y = self.place
        mean = self.grid.mean(axis=0)
        mean += 1.0
        least, first, clipped = min(self.cell, 3), self.left[0], np.clip(self.left, 0.0, 1.0)
        speed += 1.0
        least += 1
        row += 1
        x -= 1
        first += 1.0
        clipped += 1.0
        return {"fill": self.fill, "pop": self.pop, "counts": counts, "rest": (speed, least, row, column, x, y)}


@pytest.mark.parametrize("cls", [Shows, ShowsNumbers])
def test_info_dicts_without_other_changes_are_left_out(cls: type[Shows]) -> None:
    assert_equal_steps(cls(), rewrite(cls()), 60, 3)

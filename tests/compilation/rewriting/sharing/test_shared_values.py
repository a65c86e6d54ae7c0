"""Lists and arrays with two names, one of which shows a change by the other: they are refused, as copies would not."""

from typing import Any, ClassVar

import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.environments.marked import marked_line
from support.lockstep.rewriting import assert_equal_steps


def same(value):
    return value


class Shares(ExtraEnv):
    """Shares the memory of two attributes in one state only, which one reset does not show."""

    LISTS: ClassVar[dict[str, Any]] = {"two": [1, 2]}

    def reset(self, *, seed=None, options=None):
        self.first, self.second = [1, 2], [1, 2]
        self.left, self.right = np.zeros(2), np.zeros(2)
        self.grid = np.zeros((2, 2))
        return super().reset(seed=seed)

    def pick(self, value) -> Any:
        return None or value

    def pair(self) -> Any:
        made = [3, 4]
        return made, made

    def kept(self):
        made = np.zeros(2)
        self.left = made
        return made

    def share(self) -> Any:
        return None

    def extra(self):
        if self.cell == 9:
            self.share()
        self.second[0] += 1
        self.right[0] += 1.0
        return float(self.first[0] + self.left[0] + self.LISTS["two"][0])


class ByTwoTargets(Shares):
    def share(self):
        self.first = self.second = [3, 4]  # here


class ByFunction(Shares):
    def share(self):
        self.first = made = [3, 4]
        self.second = same(made)  # here


class ByOr(Shares):
    def share(self):
        self.first = made = [3, 4]
        self.second = None or made  # here


class ByOrOfFunction(Shares):
    def share(self):
        self.first = made = [3, 4]
        self.second = self.pick(made)  # here


class ByGet(Shares):
    def share(self):
        self.second = self.LISTS.get("two", 0)  # here


class ByTuples(Shares):
    def share(self):
        made = [3, 4]
        (self.first,), (self.second,) = (made,), (made,)  # here


class ByFunctionOfTwo(Shares):
    def share(self):
        self.first, self.second = self.pair()  # here


class ArraysByTwoTargets(Shares):
    def share(self):
        self.left = self.right = np.zeros(2)  # here


class ArraysByFunction(Shares):
    def share(self):
        self.left = made = np.zeros(2)
        self.right = same(made)  # here


class ArraysByKeeping(Shares):
    def share(self):
        self.right = self.kept()  # here


class InTuple(Shares):
    def reset(self, *, seed=None, options=None):
        self.places = [0, 0], 0
        return super().reset(seed=seed)

    def share(self):
        self.places = self.second, 1  # here

    def extra(self):
        return super().extra() + self.places[0][0]


class OfReset(Shares):
    def reset(self, *, seed=None, options=None):
        options = options or {}
        made = [1, 2]
        self.first = made
        result = super().reset(seed=seed)
        self.second = options.get("second", made)  # here
        return result


class Variables(Shares):
    def extra(self):
        first = np.zeros(2)
        second = None or first
        first += 1.0  # here
        return float(second[0])


class VariablesOfTwoTargets(Shares):
    def extra(self):
        first = second = np.zeros(2)
        first += 1.0  # here
        return float(second[0])


class VariablesInOneLine(Shares):
    def extra(self):
        first = np.zeros(2); (second, _) = first, 1; first += 1.0  # fmt: skip  # noqa: E702 - here
        return float(second[0])


class Rows(Shares):
    def extra(self):
        self.grid[0], self.grid[1] = self.grid[1], self.grid[0]  # here: both rows are then equal
        return float(self.grid[1, 0])


class Lists(Shares):
    def extra(self):
        first = [self.cell, 2]
        second = first
        second += [3]  # here
        return float(len(first))


class ConstantLists(Shares):
    def extra(self):
        first = second = [1, 2]
        second *= 2  # here
        return float(len(first))


class ListsOfPairs(Shares):
    def extra(self):
        first, cell = self.first, self.cell  # here
        self.first[0] += cell
        return float(first[0])


class ListOfClass(Shares):
    def extra(self):
        second = self.LISTS["two"]
        second += [3]  # here
        return float(len(self.LISTS["two"]))


class DictOfClass(Shares):
    def extra(self):
        lists = self.LISTS
        lists |= {"two": [3, 4]}  # here
        return float(self.LISTS["two"][0])


SHARED = [
    *(ByTwoTargets, ByFunction, ByOr, ByOrOfFunction, ByGet, ByTuples, ByFunctionOfTwo),
    *(ArraysByTwoTargets, ArraysByFunction, ArraysByKeeping, InTuple, OfReset),
    *(Variables, VariablesOfTwoTargets, VariablesInOneLine, Rows, Lists, ConstantLists),
    *(ListsOfPairs, ListOfClass, DictOfClass),
]


@pytest.mark.parametrize("cls", SHARED, ids=lambda cls: cls.__name__)
def test_shared_values_that_change_are_refused_with_their_line(cls: Any) -> None:
    reasons = r"shares (the )?memory|may share its memory|may have another name.* x = x [+|*] y|changed before it is"
    with pytest.raises(NotCompilable, match=reasons) as caught:
        rewrite(cls())
    assert caught.value.line == marked_line(cls)


class Copies(Shares):
    """Makes every value anew."""

    START: ClassVar = [3, 4]

    def made(self):
        made = np.zeros(2)
        made[0] = 2.0
        return made

    def share(self):
        self.first, self.second = [self.cell, 4], self.START.copy()
        made = self.START
        self.second = list(made)
        self.second = [0] * 2
        self.second = [0 for _ in range(2)]
        self.right = self.made()
        self.left, self.right = self.right.copy(), self.left + 1.0
        self.grid[0], self.grid[1] = self.grid[1].copy(), self.grid[0].copy()
        self.grid[0, 0], self.grid[1, 0] = self.grid[1, 0], self.grid[0, 0]
        more = [1]
        pair: tuple[int, ...] = (self.cell,)
        more += [2]
        pair += (3,)
        self.second[1] = len(more) + pair[1]


def test_values_that_are_made_anew_are_compiled() -> None:
    assert_equal_steps(Copies(), rewrite(Copies()), 300, 3)

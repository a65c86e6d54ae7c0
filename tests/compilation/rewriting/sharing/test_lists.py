"""Lists of numbers: copies of them and new ones are compiled, and others are refused where they change."""

from typing import Any, ClassVar

import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.environments.marked import marked_line
from support.lockstep.rewriting import assert_equal_steps

LEVEL = [1, 2]
pairs = zip


def start():
    return [0, 0]


class Moves(ExtraEnv):
    """Changes a list in every step."""

    LEVELS: ClassVar = [[1, 2], [3, 4]]

    def reset(self, *, seed=None, options=None):
        self.place, self.before, self.other = [0, 0], [0, 0], [1, 1]
        self.pair: Any = (0, 0)
        self.values, self.count = np.zeros(2), 0
        return super().reset(seed=seed)

    def extra(self) -> Any:
        self.place[0] += 1
        self.values[0] += 1.0
        return self.reward()

    def reward(self) -> Any:
        return 0.0


class Starts(Moves):
    def start(self):
        return [self.cell, 0]

    def reward(self):
        if self.cell == 5:
            self.place = self.start()
        if self.cell == 6:
            self.place = start()
        if self.cell == 7:
            self.place = self.LEVELS[1].copy()
        return float(self.place[0])


class Remembers(Moves):
    def extra(self):
        self.before, self.pair = list(self.place), tuple(self.place)
        first, second, third = tuple(self.place), self.place.copy(), self.place[:]
        self.place[0] += 1
        self.other = self.place.copy()
        self.place[1] += first[0]
        self.other[0] += 2
        return float(self.before[0] + self.pair[0] + first[0] + second[0] + third[0] + self.other[0])


class Returns(Moves):
    """Returns variables that refer to each other, and new arrays by `asarray` and `ravel`."""

    def least(self):
        low, high = 0, self.cell
        if self.cell > 4:
            low, high = high, low
        return low

    def best(self):
        best = 0
        for number in self.place:
            best = best if best > number else number
        return best

    def reward(self):
        grown, total = [1, self.cell], 0
        grown += [3]
        for number in grown:
            total += number
        self.values = np.asarray(np.clip(self.values, 0.0, 3.0))
        self.values[1] = self.least()
        flat = (self.values + 1.0).ravel()
        flat[0] += self.best()
        return float(total + flat[0] + self.values[1])


class Loops(Moves):
    """Its loops draw random numbers, and call what changes nothing."""

    def doubled(self, value):
        return 2.0 * value

    def reward(self):
        total = 0.0
        for number in self.place:
            total += number + self.np_random.random()
        for i, value in enumerate(self.values):
            total += i * self.doubled(value)
        return total


class Pairs(Moves):
    """Keeps pairs in a list, which shows no later change."""

    def reward(self):
        rows = list(zip(self.place, self.other, strict=False))
        self.place[1] += 1
        last, first = reversed(self.place)
        return float(sum(one for one, _ in rows) + sum(other for _, other in rows) + last - first)


@pytest.mark.parametrize("cls", [Starts, Remembers, Returns, Loops, Pairs])
def test_copies_and_new_lists_are_compiled(cls: type[ExtraEnv]) -> None:
    assert_equal_steps(cls(), rewrite(cls()), 300, 3)


class OfModule(Moves):
    def level(self):
        return LEVEL

    def reward(self):
        self.place = self.level()  # here
        return 0.0


class OfModuleLater(Moves):
    def level(self):
        self.count += 1
        return LEVEL

    def reward(self):
        self.place = self.level()  # here
        return float(self.count)


class KeepsByGenerator(Moves):
    def reset(self, *, seed=None, options=None):
        self.rows: Any = [[0, 0], [0, 0]]
        return super().reset(seed=seed)

    def made(self):
        made = [1, self.cell]
        self.rows = list(made for _ in range(2))  # noqa: C400 - the generator is tested
        return made

    def reward(self):
        self.place = self.made()  # here
        return float(self.rows[0][0])


class OfClass(Moves):
    def reward(self):
        self.place = self.LEVELS[0]  # here
        return 0.0


class Either(Moves):
    def either(self, given):
        return given if self.cell > 3 else [0, 0]

    def reward(self):
        mine = [1, self.cell]
        self.place = self.either(mine)  # here
        return float(mine[0])


class KeepsToo(Moves):
    def kept(self):
        made = [1, self.cell]
        self.other = made
        return made

    def reward(self):
        self.place = self.kept()  # here
        return float(self.other[0])


class MakesTwo(Moves):
    def two(self):
        made = other = [1, self.cell]
        self.other = other
        return made

    def reward(self):
        self.place = self.two()  # here
        return float(self.other[0])


class Own(Moves):
    def own(self):
        return self.other

    def reward(self):
        self.place = self.own()  # here
        return 0.0


class OfOwn(Moves):
    def reset(self, *, seed=None, options=None):
        self.rows = [[0, 0], [0, 0]]
        return super().reset(seed=seed)

    def both(self):
        return [self.place, self.place]

    def reward(self):
        self.rows = self.both()  # here
        return float(self.rows[0][0])


class CopiesRows(Moves):
    def reset(self, *, seed=None, options=None):
        self.rows, self.old = [[0, 0], [0, 0]], [[0, 0], [0, 0]]
        return super().reset(seed=seed)

    def reward(self):
        self.old = self.rows.copy()  # here
        self.rows[0] = [self.cell, 1]
        return float(self.old[0][0])


class CallsChange(Moves):
    def grow(self, value):
        self.place[1] += 1
        return value

    def reward(self):
        total = 0.0
        for number in self.place:  # here
            total += self.grow(number)
        return total


class ReadsChange(Moves):
    @property
    def grown(self):
        self.place[1] += 1
        return 1

    def reward(self):
        total = 0.0
        for number in self.place:  # here
            total += self.grown * number
        return total


class PairsByOtherName(Moves):
    def reward(self):
        total = 0.0
        for one, other in pairs(self.place, self.other):  # here
            self.place[1] += 1
            total += one + other
        return total


class PairsOfStar(Moves):
    def reward(self):
        total = 0.0
        for one, other in zip(*[self.place, self.other], strict=False):  # here
            self.place[1] += 1
            total += one + other
        return total


class EitherReversed(Moves):
    def reward(self):
        total = 0.0
        for number in reversed(self.place) if self.cell > 3 else reversed(self.other):  # here
            self.place[0] += 1
            total += number
        return total


REFUSED = [
    *(OfModule, OfModuleLater, KeepsByGenerator, OfClass, Either, KeepsToo, MakesTwo, Own, OfOwn, CopiesRows),
    *(CallsChange, ReadsChange, PairsByOtherName, PairsOfStar, EitherReversed),
]


@pytest.mark.parametrize("cls", REFUSED, ids=lambda cls: cls.__name__)
def test_lists_with_other_names_that_change_are_refused(cls: type[ExtraEnv]) -> None:
    with pytest.raises(NotCompilable, match=r"shares (the )?memory") as caught:
        rewrite(cls())
    assert caught.value.line == marked_line(cls)

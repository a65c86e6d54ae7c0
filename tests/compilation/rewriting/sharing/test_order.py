"""An array that a later call in the same statement changes: Python shows the change, so that it is refused."""

from typing import Any

import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.environments.marked import marked_line


class Bumps(ExtraEnv):
    """Has methods and a property that change an array."""

    def bump(self):
        self.board[1] += 1.0
        return self.board[1]

    def index(self):
        self.board[1] += 1.0
        return 1

    @property
    def spot(self):
        self.board[1] += 1.0
        return 1

    def ones(self):
        self.board[1] += 1.0
        return np.ones(4)

    def inner(self):
        return self.board

    def first(self, values, factor):
        return values[1] * factor


class Indexes(Bumps):
    def extra(self):
        return self.board[self.index()]  # here


class IndexesByProperty(Bumps):
    def extra(self):
        return self.board[self.spot]  # here


class Passes(Bumps):
    def extra(self):
        return self.first(self.board, self.bump())  # here


class Compares(Bumps):
    def extra(self):
        if self.first(self.board, self.bump()) > 2.0:  # here
            return 1.0
        return 0.0


class RepeatsWhile(Bumps):
    def extra(self):
        while self.first(self.board, self.bump()) < 9.0:  # here
            self.cell += 1
        return 0.0


class CountsTo(Bumps):
    def extra(self):
        total = 0.0
        for i in range(int(self.first(self.board, self.bump()))):  # here
            total += i
        return total


class LoopsOver(Bumps):
    def extra(self):
        total = 0.0
        for value in self.board * self.bump():  # here
            total += value
        return total


class Enumerates(Bumps):
    def extra(self):
        total = 0.0
        for i, value in enumerate(self.board + self.ones()):  # here
            total += i * value
        return total


class Adds(Bumps):
    def extra(self):
        self.board += self.ones()  # here
        return 0.0


class Multiplies(Bumps):
    def extra(self):
        values = self.board * self.bump()  # here
        return values[1]


class Clips(Bumps):
    def extra(self):
        return np.minimum(self.board, self.bump())[1]  # here


class ReturnsBoth(Bumps):
    def both(self):
        return self.board, self.bump()  # here

    def extra(self):
        values, number = self.both()
        return values[1] + number


class ReturnsInner(Bumps):
    def both(self):
        return self.inner(), self.bump()  # here

    def extra(self):
        values, number = self.both()
        return values[1] + number


class LoopsOverBoth(Bumps):
    def extra(self):
        total = 0.0
        for values in (self.ones(), self.board):  # here
            total += values[1] + self.index()
        return total


class LoopsOverPairs(Bumps):
    def extra(self):
        total = 0.0
        for number, other in zip(self.board.copy(), self.board, strict=True):  # here
            self.board[3] += 1.0
            total += number + other
        return total


class LoopsOverList(Bumps):
    def reset(self, *, seed=None, options=None):
        self.places = [1, 2, 3]
        return super().reset(seed=seed)

    def extra(self):
        total = self.board[0]
        for place in self.places:  # here: Python reads the places in each round
            self.places[2] = 7
            total += place
        return total


class ReadsNumbers(Bumps):
    def extra(self):
        total = self.board[1] * self.bump() + self.board[1] + self.board[self.cell % 4]
        return total + self.bump() * self.board[1]


REFUSED = [
    *(Indexes, IndexesByProperty, Passes, Compares, RepeatsWhile, CountsTo, LoopsOver, Enumerates),
    *(Adds, Multiplies, Clips, ReturnsBoth, ReturnsInner, LoopsOverBoth, LoopsOverPairs, LoopsOverList),
]


@pytest.mark.parametrize("cls", REFUSED, ids=lambda cls: cls.__name__)
def test_an_array_that_a_later_call_changes_is_refused(cls: Any) -> None:
    with pytest.raises(NotCompilable) as caught:
        rewrite(cls())
    assert caught.value.line == marked_line(cls)
    assert ("self.places" if cls is LoopsOverList else "self.board") in caught.value.reason


def test_numbers_are_read_in_pythons_order() -> None:
    env = ReadsNumbers()
    rewritten = rewrite(env)
    record, rng = rewritten.initial.copy()[0], np.random.default_rng(0)
    env.reset(seed=0)
    rewritten.reset(record, rng)
    for _ in range(9):
        assert rewritten.step(record, 1, rng)[:2] == env.step(1)[:2]

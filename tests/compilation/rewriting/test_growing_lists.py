"""Values that steps add to and nothing reads are left out, lists only if ``reset`` makes them."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.lockstep.rewriting import assert_equal_steps

OUTSIDE: list[int] = []


class Records(ExtraEnv):
    """Keeps its path, which only ``render`` reads."""

    def reset(self, *, seed=None, options=None):
        self.path, self.rewards = [0], []
        self.path.append(1)
        return super().reset(seed=seed)

    def extra(self) -> Any:
        self.path.append(self.cell)
        self.rewards.extend([0.5, 1.0 * self.cell])
        return 0.5 * self.cell

    def render(self):
        return len(self.path)


class MadeOnce(ExtraEnv):
    def __init__(self):
        super().__init__()
        self.path = []

    def extra(self):
        self.path.append(self.cell)
        return 0.0


class MadeSometimes(MadeOnce):
    def reset(self, *, seed=None, options=None):
        cell, info = super().reset(seed=seed)
        if self.np_random.random() < 0.5:
            self.path = []
        return cell, info


class OfOthers(MadeOnce):
    def reset(self, *, seed=None, options=None):
        self.path = OUTSIDE
        return super().reset(seed=seed)


class OfOthersByPosition(MadeOnce):
    def reset(self, /, *, seed=None, options=None):
        self.path = OUTSIDE
        return super().reset(seed=seed)


class IsRead(Records):
    def extra(self):
        self.path.append(self.cell)
        return float(len(self.path))


class Draws(Records):
    def extra(self):
        self.path.append(int(self.np_random.integers(3)))
        return 0.0


class AddsToOwn(ExtraEnv):
    pair: Any

    def reset(self, *, seed=None, options=None):
        gym.Env.reset(self, seed=seed)
        self.cell, self.board = 0, np.zeros(4)
        self.total, self.text, self.pair = 0.0, "a", (1,)
        self.path = [0]
        self.sums = self.board.copy()
        return self.cell, {}

    def extra(self):
        self.path += [self.cell]
        self.total += 0.5
        self.text += "b"
        self.pair += (self.cell,)
        self.sums += 1.0
        return float(self.board[0])


class AddsToOutside(ExtraEnv):
    path: Any

    def __init__(self):
        super().__init__()
        self.path = OUTSIDE

    def extra(self):
        if self.cell == 9 and self.np_random.random() < 1e-9:
            self.path += [self.cell]
        return float(len(OUTSIDE))


class AddsToOutsideOfReset(AddsToOutside):
    def reset(self, *, seed=None, options=None):
        self.path = OUTSIDE
        return super().reset(seed=seed)


class AddsToCopyOfOwn(AddsToOutside):
    def copy(self):
        return OUTSIDE

    def reset(self, *, seed=None, options=None):
        self.path = self.copy()
        return super().reset(seed=seed)


class AddsToTwoNames(AddsToOutside):
    def extra(self):
        cells: list[int]
        self.path = cells = []
        if self.cell == 9 and self.np_random.random() < 1e-9:
            self.path += [self.cell]
        return float(len(cells))


class AddsToBoard(AddsToOwn):
    def extra(self):
        if self.cell == 9 and self.np_random.random() < 1e-9:
            self.sums = self.board
            self.sums += 1.0
        return float(self.board[0])


class AddsToBoardOfTuple(AddsToOwn):
    def extra(self):
        if self.cell == 9 and self.np_random.random() < 1e-9:
            self.sums, more = self.board, 1.0
            self.sums += more
        return float(self.board[0])


def test_they_are_left_out() -> None:
    rewritten = rewrite(Records())
    assert "path" not in str(rewritten.dtype)
    assert rewritten.shown.refusal is None
    assert_equal_steps(Records(), rewritten, 60, 3)


def test_additions_to_own_values_are_left_out() -> None:
    rewritten = rewrite(AddsToOwn())
    assert set(rewritten.dtype.names or ()) == {"cell", "board"}
    assert_equal_steps(AddsToOwn(), rewritten, 60, 3)


ADD_TO_OTHERS = [AddsToOutside, AddsToOutsideOfReset, AddsToTwoNames, AddsToBoard, AddsToBoardOfTuple, AddsToCopyOfOwn]


@pytest.mark.parametrize("cls", ADD_TO_OTHERS, ids=lambda cls: cls.__name__)
def test_additions_to_values_with_other_names_are_refused(cls: Any) -> None:
    with pytest.raises(NotCompilable, match=r"self\.(path|sums)") as caught:
        rewrite(cls())
    assert caught.value.advice


OTHERS = [MadeOnce, MadeSometimes, OfOthers, OfOthersByPosition, IsRead, Draws]


@pytest.mark.parametrize("cls", OTHERS, ids=lambda cls: cls.__name__)
def test_others_are_refused(cls: Any) -> None:
    with pytest.raises(NotCompilable, match=r"self\.path|left out in compiled code") as caught:
        rewrite(cls())
    assert caught.value.advice
    assert OUTSIDE == []

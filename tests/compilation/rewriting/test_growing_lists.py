"""Lists that steps append to and nothing reads are left out, if ``reset`` makes them."""

from typing import Any

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


class IsRead(Records):
    def extra(self):
        self.path.append(self.cell)
        return float(len(self.path))


class Draws(Records):
    def extra(self):
        self.path.append(int(self.np_random.integers(3)))
        return 0.0


def test_they_are_left_out() -> None:
    rewritten = rewrite(Records())
    assert "path" not in str(rewritten.dtype)
    assert rewritten.shown.refusal is None
    assert_equal_steps(Records(), rewritten, 60, 3)


@pytest.mark.parametrize("cls", [MadeOnce, MadeSometimes, OfOthers, IsRead, Draws], ids=lambda cls: cls.__name__)
def test_others_are_refused(cls: Any) -> None:
    with pytest.raises(NotCompilable, match=r"self\.path|left out in compiled code") as caught:
        rewrite(cls())
    assert caught.value.advice
    assert OUTSIDE == []

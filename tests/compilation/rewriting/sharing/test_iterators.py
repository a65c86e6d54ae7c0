"""Iterators that are kept or returned, which can be read only once: they are refused."""

from typing import Any

import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.environments.marked import marked_line


class Keeps(ExtraEnv):
    def reset(self, *, seed=None, options=None):
        self.place = [0, 0]
        return super().reset(seed=seed)

    def extra(self) -> Any:
        self.place[0] += 1
        return self.reward()

    def reward(self) -> Any:
        return 0.0


class KeepsReversed(Keeps):
    def reward(self):
        numbers = reversed(self.place)  # here
        return float(sum(numbers) + sum(numbers))


class KeepsNumbers(Keeps):
    def reward(self):
        numbers = enumerate((3, 4))  # here
        return float(sum(one for one, _ in numbers) + sum(one for one, _ in numbers))


class KeepsGenerator(Keeps):
    def reward(self):
        numbers = (number + 1 for number in self.place)  # here
        self.place[1] = 7
        return float(sum(numbers))


class ReturnsReversed(Keeps):
    def turned(self):
        return reversed(self.place)  # here

    def reward(self):
        return float(sum(self.turned()))


@pytest.mark.parametrize("cls", [KeepsReversed, KeepsNumbers, KeepsGenerator, ReturnsReversed])
def test_iterators_which_can_be_read_only_once_are_not_kept(cls: type[ExtraEnv]) -> None:
    with pytest.raises(
        NotCompilable, match=r"an iterator, which can be read only once.*write (list\(|a list)"
    ) as caught:
        rewrite(cls())
    assert caught.value.line == marked_line(cls)
    assert caught.value.advice.startswith(("write list(", "write a list"))

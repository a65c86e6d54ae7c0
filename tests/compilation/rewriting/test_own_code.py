"""Code of the user that compiled code would not run, or would run once: it is refused with its line."""

import enum
from typing import Any, NamedTuple

import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv
from support.environments.marked import marked_line


class Heading(enum.IntEnum):
    """Adds in a circle."""

    NORTH = 0
    EAST = 1

    def __add__(self, other):
        return (int(self) + int(other)) % 2


class Access(enum.IntFlag):
    """Inverts otherwise than integers."""

    READ = 4

    def __invert__(self):
        return 3


class Price(float, enum.Enum):
    """Multiplies otherwise than floats."""

    LOW = 1.5

    def __mul__(self, other):
        return 100.0


class Meters(int):
    """Compares otherwise than integers."""

    def __eq__(self, other):
        return True

    __hash__ = int.__hash__


class Plain(enum.IntEnum):
    """Has a method, but no operators."""

    LEFT = -1
    RIGHT = 1

    def shown(self):
        return self.name


class AddsEnum(ExtraEnv):
    def extra(self):
        return float(Heading.EAST + self.cell)  # here


class AddsToEnum(ExtraEnv):
    def extra(self):
        return float(self.cell + Heading.EAST)  # here


class AddsConstants(ExtraEnv):
    def extra(self):
        return float(Heading.EAST + 1)  # here


class InvertsFlag(ExtraEnv):
    def extra(self):
        return float(~Access.READ)  # here


class MultipliesFloat(ExtraEnv):
    def extra(self):
        return Price.LOW * self.board[0]  # here


class KeepsEnum(ExtraEnv):
    def reset(self, *, seed=None, options=None):
        result = super().reset(seed=seed)
        self.heading = Heading.NORTH  # here
        return result

    def extra(self):
        self.heading = Heading.EAST
        return float(self.heading + 1)


class ComparesConstant(ExtraEnv):
    def __init__(self):
        super().__init__()
        self.goal = Meters(3)

    def extra(self):
        return 1.0 if self.cell == self.goal else 0.0  # here


class LooksUp(ExtraEnv):
    COSTS = (1.0, 2.0)

    def extra(self):
        return self.COSTS[Heading.EAST]  # here


class ComputesWithPlainEnums(ExtraEnv):
    def extra(self):
        return float(Plain.RIGHT + self.cell) + Plain.LEFT.value + Heading.EAST.value


OPERATORS = [
    AddsEnum, AddsToEnum, AddsConstants, InvertsFlag, MultipliesFloat, KeepsEnum, ComparesConstant, LooksUp
]  # fmt: skip


def refusal(cls: Any) -> NotCompilable:
    """Returns the refusal of a class, which names the line with the mark."""
    with pytest.raises(NotCompilable) as caught:
        rewrite(cls())
    assert caught.value.line == marked_line(cls)
    return caught.value


@pytest.mark.parametrize("cls", OPERATORS, ids=lambda cls: cls.__name__)
def test_operators_of_numbers_and_enums_that_a_class_defines_are_refused(cls: Any) -> None:
    refused = refusal(cls)
    assert "which compiled code does not call" in refused.reason
    assert "leave the method out" in refused.advice


def test_enums_without_operators_are_numbers() -> None:
    env = ComputesWithPlainEnums()
    rewritten = rewrite(env)
    record, rng = rewritten.initial.copy()[0], np.random.default_rng(0)
    env.reset(seed=0)
    rewritten.reset(record, rng)
    assert rewritten.step(record, 1, rng)[:2] == env.step(1)[:2]


COUNT = [0]


class Lamp(enum.Enum):
    """Has a property that counts."""

    ON = 1

    @property
    def bonus(self):
        COUNT[0] += 1
        return float(COUNT[0])


class Level:
    """Counts how often it is read."""

    def __get__(self, instance, owner=None):
        COUNT[0] += 1
        return float(COUNT[0])


class Meta(type):
    """Has a property that counts."""

    @property
    def limit(cls):
        COUNT[0] += 1
        return float(COUNT[0])


class Settings(metaclass=Meta):
    """Has a number and a descriptor."""

    level = Level()
    bonus = 2.0


class Pair(NamedTuple):
    """Has fields and a property that counts."""

    first: float

    @property
    def total(self):
        COUNT[0] += 1
        return self.first + COUNT[0]


class ReadsProperty(ExtraEnv):
    def extra(self):
        return Lamp.ON.bonus  # here


class ReadsDescriptor(ExtraEnv):
    def extra(self):
        return Settings.level  # here


class ReadsOfMetaclass(ExtraEnv):
    def extra(self):
        return Settings.limit  # here


class ReadsOfTuple(ExtraEnv):
    PAIR = Pair(1.0)

    def extra(self):
        return self.PAIR.total  # here


class ReadsNumbers(ExtraEnv):
    PAIR = Pair(1.0)

    def extra(self):
        return Lamp.ON.value + Settings.bonus + self.PAIR.first


@pytest.mark.parametrize("cls", [ReadsProperty, ReadsDescriptor, ReadsOfMetaclass, ReadsOfTuple])
def test_attributes_of_constants_that_are_computed_are_refused(cls: Any) -> None:
    before = COUNT[0]
    function = cls.__dict__["extra"]
    scope_env = cls()
    with pytest.raises(NotCompilable, match="computed by code") as caught:
        rewrite(scope_env)
    assert caught.value.line == function.__code__.co_firstlineno + 1
    assert COUNT[0] == before


def test_plain_attributes_of_constants_are_read() -> None:
    assert rewrite(ReadsNumbers()).source

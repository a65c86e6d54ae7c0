"""Data whose class has code of its own: none of it is run before the environment is refused with its line."""

import enum
import types
from dataclasses import dataclass
from typing import Any, NamedTuple

import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from qtab.compilation.twins.plain_data import is_plain
from qtab.compilation.twins.side_effects import refuse_effects
from support.environments.gym_classes.extra import ExtraEnv
from support.environments.marked import marked_line

COUNT = [0]


def counted(*_: Any) -> float:
    COUNT[0] += 1
    return float(COUNT[0])


class Pair(NamedTuple):
    """Computes its elements."""

    first: float

    def __getitem__(self, index):
        return counted()


class Shown(NamedTuple):
    """Has a text of its own, and a property that nothing reads."""

    first: float

    def __str__(self):
        return "shown"

    @property
    def twice(self):
        return 2 * self.first


@dataclass
class Guessing:
    """Computes attributes that it does not have."""

    first: float = 1.0

    def __getattr__(self, name):
        if name == "bonus":
            return counted()
        raise AttributeError(name)


@dataclass
class Adding:
    """Has an operator."""

    first: float = 1.0

    def __add__(self, other):
        return counted()


@dataclass(frozen=True, order=True, slots=True)
class Fixed:
    """Has the methods that ``dataclass`` writes, and a text of its own."""

    first: float = 1.0

    def __repr__(self):
        return "fixed"


class Meta(type):
    """Has a property."""

    limit = property(counted)


class Limits(metaclass=Meta):
    """Has a number that its class computes."""


class Equal(enum.IntEnum):
    """Compares otherwise than integers."""

    ONE = 1

    def __eq__(self, other):
        return bool(counted())

    __hash__ = enum.IntEnum.__hash__


class Shouting(enum.IntEnum):
    """Has a text that is counted."""

    ONE = 1

    def __str__(self):
        return f"{counted()}!"


class Turning(enum.IntEnum):
    """Has an operator and a text without effects."""

    ONE = 1
    TWO = 2

    def __add__(self, other):
        return Turning((self.value + other) % 2 + 1)

    def __str__(self):
        return self.name.lower()


module = types.ModuleType("module")
module.__getattr__ = counted  # type: ignore[method-assign]


class ReadsElement(ExtraEnv):
    PAIR = Pair(1.0)

    def extra(self):
        return self.PAIR[0]  # here


class ReadsGuessed(ExtraEnv):
    def __init__(self):
        super().__init__()
        self.guessing = Guessing()

    def extra(self):
        return self.guessing.bonus  # here


class AddsData(ExtraEnv):
    def __init__(self):
        super().__init__()
        self.adding = Adding()

    def extra(self):
        return self.adding + 1.0  # here


class ReadsModule(ExtraEnv):
    def extra(self):
        return module.level  # here


class ReadsMetaclass(ExtraEnv):
    def extra(self):
        return Limits.limit  # here


class Compares(ExtraEnv):
    def extra(self):
        if Equal.ONE == 1:  # here
            return 1.0
        return 0.0


class Searches(ExtraEnv):
    GOALS = (Equal.ONE, 2)

    def extra(self):
        return 1.0 if 2 in self.GOALS else 0.0  # here


class ShowsInInfo(ExtraEnv):
    def step(self, action):
        return self.cell, 0.0, False, False, {"text": f"{Shouting.ONE}"}  # here


class ShowsByHelper(ExtraEnv):
    SHOWN = (Shouting.ONE,)

    def shown(self):
        return {"text": str(self.SHOWN[0])}

    def step(self, action):
        return self.cell, 0.0, False, False, self.shown()  # here


class ShowsWithoutEffects(ExtraEnv):
    def step(self, action):
        return self.cell, 0.0, False, False, {"text": str(Turning.ONE), "next": Turning.ONE + 1}


def checked_and_rewritten(env: Any) -> Any:
    refuse_effects(env)
    return rewrite(env)


REFUSED = [
    ReadsElement,
    ReadsGuessed,
    AddsData,
    ReadsModule,
    ReadsMetaclass,
    Compares,
    Searches,
    ShowsInInfo,
    ShowsByHelper,
]


@pytest.mark.parametrize("cls", REFUSED, ids=lambda cls: cls.__name__)
def test_code_of_data_is_not_run(cls: Any) -> None:
    env, before = cls(), COUNT[0]
    with pytest.raises(NotCompilable) as caught:
        checked_and_rewritten(env)
    assert caught.value.line == marked_line(cls)
    assert caught.value.advice
    assert COUNT[0] == before


def test_methods_that_are_generated_or_only_show_data_leave_it_plain() -> None:
    assert [is_plain(one) for one in (Shown(1.0), Fixed(), [Fixed()])] == [True] * 3
    assert [is_plain(one) for one in (Pair(1.0), Guessing(), [Adding()])] == [False] * 3


def test_texts_and_operators_without_effects_may_be_left_out() -> None:
    assert checked_and_rewritten(ShowsWithoutEffects()).source

"""qtab.tabulate refuses ordinary Gymnasium classes with a state that comparing their attributes would not show."""

import random
from collections import deque
from enum import IntEnum
from types import SimpleNamespace

import numpy as np
import pytest

import qtab
from support.environments.own.gymnasium_class import Corridor, corridor


class Board(list[int]):
    """A list with an attribute."""

    turn = 0


class History(deque[int]):
    """A collection that is written in C."""


class Slotted:
    """A class without ``__dict__``."""

    __slots__ = ("moves",)


class BelowSlotted(Slotted):
    """A class with ``__dict__``, and a base without it."""


class Dice(random.Random):
    """Another generator, of a base written in C."""


class Color(IntEnum):
    """A number with attributes that do not change."""

    RED = 1


def keep(make, change):
    """A corridor that keeps an object and changes it in each step, and ends after four."""

    def reset(self, **arguments):
        self.kept = make()
        return Corridor.reset(self, **arguments)

    def step(self, action):
        change(self.kept)
        return Corridor.step(self, action)

    return corridor(reset=reset, step=step)


def turn(board):
    board.turn += 1


def move(slotted):
    slotted.moves = getattr(slotted, "moves", 0) + 1


@pytest.mark.parametrize(
    ("make", "change", "text"),
    [
        (Board, turn, r"self\.kept is a Board with attributes of its own"),
        (History, lambda history: history.append(1), r"self\.kept is a History, with the base deque written in C"),
        (BelowSlotted, move, r"self\.kept is a BelowSlotted, whose base Slotted has __slots__"),
        (lambda: Dice(0), lambda dice: dice.random(), r"self\.kept is a Dice, with the base Random written in C"),
    ],
    ids=["list", "deque", "slots", "Random"],
)
def test_objects_with_a_state_outside_their_attributes_are_refused(make, change, text):
    with pytest.raises(ValueError, match=text):
        qtab.tabulate(keep(make, change), max_states=200)


def test_an_environment_with_slots_is_refused():
    def step(self, action):
        self.moves = getattr(self, "moves", 0) + 1
        return Corridor.step(self, action)

    env = type("Slots", (Corridor,), {"__slots__": ("moves",), "step": step})()
    with pytest.raises(ValueError, match="it is a Slots, which has __slots__"):
        qtab.tabulate(env, max_states=200)


def test_members_of_enumerations_and_lists_without_attributes_are_compared():
    for make in (lambda: Color.RED, lambda: type("Plain", (list,), {})([1]), lambda: SimpleNamespace(a=1)):
        assert len(qtab.tabulate(keep(make, lambda kept: None)).P) == len(qtab.tabulate(Corridor()).P)


def resetting(begin, **attributes):
    """A corridor whose resets also call a function, and with other attributes."""

    def reset(self, **arguments):
        Corridor.reset(self, **arguments)
        begin(self)
        return self.place, {}

    env = corridor(reset=reset)
    vars(env).update(attributes)
    return env


def alternate(env):
    env.turn = 1 - env.turn
    env.place = env.turn


def start_where_it_ended(env):
    env.place = getattr(env, "last", 0)


def remember(self, action):
    answer = Corridor.step(self, action)
    self.last = min(self.place, 2)
    return answer


def test_an_episode_that_begins_differently_after_another_is_refused():
    text = r"reset of Corridor must not depend on what an earlier episode left .*'place': 4.*, it sets self\.place to"
    with pytest.raises(ValueError, match=text):
        qtab.tabulate(resetting(alternate, turn=0))
    env = resetting(start_where_it_ended)
    type(env).step = remember
    with pytest.raises(ValueError, match=text):
        qtab.tabulate(env)

    def observed(self, **arguments):
        Corridor.reset(self, **arguments)
        return getattr(self, "last", 0), {}

    with pytest.raises(ValueError, match="it returns other observations or masks"):
        qtab.tabulate(corridor(reset=observed, step=remember))


def test_attributes_that_no_reset_uses_may_survive_an_episode():
    expected = qtab.tabulate(Corridor())
    last = qtab.tabulate(corridor(step=remember))
    assert len(last.P) > len(expected.P)
    assert np.array_equal(last.initial_state_distrib[:2], [0.5, 0.5])
    built = resetting(lambda env: setattr(env, "walls", getattr(env, "walls", [1, 2])))
    assert qtab.tabulate(built).P == expected.P


def test_class_attributes_that_steps_change_are_refused():
    def step(self, action):
        self.places[0] += 1
        return Corridor.step(self, action)

    def below(self, action):
        type(self).steps = getattr(self, "steps", 0) + 1
        return Corridor.step(self, action)

    for method, attributes, name in ((step, {"places": np.zeros(1)}, "places"), (below, {}, "steps")):
        with pytest.raises(ValueError, match=rf"its steps changed Corridor\.{name}$"):
            qtab.tabulate(corridor(step=method, **attributes))

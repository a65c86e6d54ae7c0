"""qtab.tabulate refuses functional environments that keep in attributes what changes, or that have other steps."""

import math
from collections import deque
from functools import cached_property
from typing import Any

import numpy as np
import pytest

import qtab
from support.environments.own.small import Line, line


def test_other_steps_and_resets_than_those_of_a_functional_environment_are_refused():
    def step(self, action):
        observation, reward, *others = Line.step(self, action)
        return observation, float(reward) - 10, *others

    for name, method in (("step", step), ("reset", lambda self, **arguments: Line.reset(self, **arguments))):
        below = type("Below", (type(line(**{name: method})),), {})
        with pytest.raises(ValueError, match=f"env must not override step or reset .* its class Line overrides {name}"):
            qtab.tabulate(below())
    env: Any = Line()
    env.step = lambda action: step(env, action)
    with pytest.raises(ValueError, match="its method step was replaced"):
        qtab.tabulate(env)


def test_the_attributes_of_a_functional_environment_are_not_changed():
    def counting(self, state, action, rng):
        self.counts[0] += 1
        return min(state + action, 4), -1.0, state + action >= 4

    env: Any = line(transition=counting)
    env.counts = np.zeros(1)
    with pytest.raises(ValueError, match=r"a method of Line changed self\.counts"):
        qtab.tabulate(env)
    assert env.counts[0] == 0
    other: Any = Line()
    other.maths = math  # a module cannot be copied
    assert len(qtab.tabulate(other).P) == 5


def test_a_random_number_in_an_attribute_is_refused_as_a_change():
    def keeping(self, state, action, rng):
        self.luck = rng.random()
        return min(state + action, 4), -1.0, state + action >= 4

    with pytest.raises(ValueError, match=r"a method of Line changed self\.luck"):
        qtab.tabulate(line(transition=keeping))


def test_an_attribute_with_the_name_of_a_method_is_not_called():
    env: Any = Line()
    env.outcomes, env.initial_outcomes = [(1, 2)], 3
    assert qtab.tabulate(env).P == qtab.tabulate(Line()).P


class Computed(Line):
    """A Line whose last place is computed once."""

    @cached_property
    def lasts(self) -> list[int]:
        """The last place."""
        return [4]

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        state = min(state + action, self.lasts[0])
        return state, -1.0, state == self.lasts[0]


def test_a_cached_property_is_no_change_unless_its_value_changes():
    assert qtab.tabulate(Computed()).P == qtab.tabulate(Line()).P

    def changing(self, state, action, rng):
        self.lasts.append(state)
        return Computed.transition(self, state, action, rng)

    with pytest.raises(ValueError, match=r"a method of Computed changed self\.lasts"):
        qtab.tabulate(type("Computed", (Computed,), {"transition": changing})())


def test_attributes_of_a_functional_environment_that_cannot_be_compared_are_refused():
    def hidden(self, state, action, rng):
        self.history.append(state)
        return min(state + action, 4), float(len(self.history) > 4), state + action >= 4

    env: Any = line(transition=hidden)
    env.history = deque()
    with pytest.raises(ValueError, match=r"in Line, self\.history is a collections\.deque, which cannot be compared"):
        qtab.tabulate(env)

    def keeping(self, state, action, rng):
        self.cache = object()
        return min(state + action, 4), -1.0, state + action >= 4

    with pytest.raises(ValueError, match=r"in Line, self\.cache is a builtins\.object"):
        qtab.tabulate(line(transition=keeping))


def test_functions_and_references_to_itself_are_no_changes():
    env: Any = Line()
    env.best, env.move, env.moves, env.this = math.nan, lambda state: env, {0: env.observe}, [env]
    assert qtab.tabulate(env).P == qtab.tabulate(Line()).P

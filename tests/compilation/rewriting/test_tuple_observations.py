"""Observations that a class makes itself are returned as numbers, without an array, and stay equal to the bit."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from qtab.compilation.layouts.observation_layout import ObservationLayout
from qtab.compilation.ordinary import OrdinaryEnv
from qtab.compilation.rewriting.rewrite import rewrite
from qtab.compilation.rewriting.tuple_observations import with_tuple_observations


class Moving(gym.Env[Any, Any]):
    """A position that an action moves."""

    observation_space = gym.spaces.Box(-100, 100, (2,), np.float32)
    action_space = gym.spaces.Discrete(2)

    def __init__(self) -> None:
        self.position, self.steps = 0.0, 0


class Walker(Moving):
    """The observation is in the return statement."""

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        super().reset(seed=seed)
        self.position, self.steps = self.np_random.uniform(-1, 1), 0
        return np.array([self.position, self.steps], dtype=np.float32), {}

    def step(self, action: int) -> Any:
        self.position += 0.1 * action - 0.03
        self.steps += 1
        return np.array([self.position, self.steps], dtype=np.float32), -1.0, self.steps >= 20, False, {}


class OfMethod(Moving):
    """The observation of a method, in a variable."""

    def _get_obs(self) -> Any:
        if self.steps % 2 == 0:
            return np.array([self.position, self.steps], dtype=np.float32)
        return np.array([self.steps, self.position], dtype=np.float32)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        super().reset(seed=seed)
        self.position, self.steps = self.np_random.uniform(-1, 1), 0
        observation = self._get_obs()
        return observation, {}

    def step(self, action: int) -> Any:
        self.position += 0.1 * action
        self.steps += 1
        observation = self._get_obs()
        return observation, -1.0, self.steps >= 20, False, {}


class ReadsIt(OfMethod):
    """The observation is read before it is returned."""

    def step(self, action: int) -> Any:
        self.position += 0.1 * action
        self.steps += 1
        observation = self._get_obs()
        reward = float(observation[0])
        return observation, reward, self.steps >= 20, False, {}


def _episode(rewritten: Any) -> list[Any]:
    """Returns the observations of an episode in Python, and the results of its steps."""
    record, rng = rewritten.initial.copy()[0], np.random.default_rng(4)
    found = [rewritten.reset(record, rng)]
    for action in (0, 1, 1, 0, 1):
        observation, *rest = rewritten.step(record, action, rng)
        found += [observation, rest]
    return found


@pytest.mark.parametrize("make", [Walker, OfMethod, ReadsIt])
def test_numbers_are_those_of_the_arrays(make: type[Moving]) -> None:
    arrays = rewrite(make())
    tuples = with_tuple_observations(arrays)
    for one, other in zip(_episode(tuples), _episode(arrays), strict=True):
        assert np.array(one).dtype == np.array(other).dtype
        assert np.array(one).tobytes() == np.array(other).tobytes()


@pytest.mark.parametrize(("make", "are_tuples"), [(Walker, True), (OfMethod, True), (ReadsIt, False)])
def test_only_vectors_that_nothing_else_reads_become_tuples(make: type[Moving], are_tuples: bool) -> None:
    rewritten = with_tuple_observations(rewrite(make()))
    record, rng = rewritten.initial.copy()[0], np.random.default_rng(0)
    rewritten.reset(record, rng)
    assert isinstance(rewritten.step(record, 1, rng)[0], tuple) is are_tuples


def test_long_vectors_stay_arrays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("qtab.compilation.rewriting.tuple_observations.MOST_NUMBERS", 1)
    arrays = rewrite(Walker())
    assert with_tuple_observations(arrays).source == arrays.source


@pytest.mark.parametrize("make", [Walker, OfMethod])
def test_lines_of_the_class_are_known_as_before(make: type[Moving]) -> None:
    arrays = rewrite(make())
    tuples = with_tuple_observations(arrays)
    for name in ("reset", "step"):
        called = [one for one in tuples.namespace if one.startswith("o_") and one.endswith(f"_{name}")]
        assert called
    text, before = tuples.source.splitlines(), arrays.source.splitlines()
    copied = [line for line in tuples.lines if line > len(before)]
    assert {tuples.lines[line] for line in copied} <= set(arrays.lines.values())
    assert all(text[line - 1].startswith(("def o_", " ")) for line in copied)


@pytest.mark.parametrize("make", [Walker, OfMethod])
def test_machine_code_allocates_nothing(make: type[Moving], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("numba")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    code = OrdinaryEnv(make())._make(ObservationLayout.of(make.observation_space))
    assert not [name for name in code.needed if name.startswith("NRT_")]

"""Benchmarks that are compared do the same work beside what they measure."""

import sys
from types import SimpleNamespace
from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.bench import environments, overhead, table_numba
from qtab.config.presets import preset


def test_the_bare_loop_seeds_the_idle_environment_as_training_does(monkeypatch: pytest.MonkeyPatch) -> None:
    seeds: list[int | None] = []

    class Recorded(overhead.IdleEnv):
        def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
            seeds.append(seed)
            return super().reset(seed=seed, options=options)

    monkeypatch.setattr(overhead, "IdleEnv", Recorded)
    monkeypatch.setattr(overhead, "EPISODES", 3)
    loops = overhead.python_stepping()
    for name in (overhead.BARE, overhead.LEARNING):
        seeds.clear()
        loops[name](7)
        assert seeds == [7, None, None], name


@pytest.mark.parametrize("name", environments.TABLES)
def test_a_round_of_the_loop_over_a_table_makes_no_environment(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    settings = {**preset(name, None)[1], "episodes": 20}
    monkeypatch.setattr(table_numba, "preset", lambda *_: (None, settings))
    expected = [int(qtab.train(name, seed=seed, episodes=20).episode_lengths.sum()) for seed in (3, 4)]
    monkeypatch.setitem(sys.modules, "numba", SimpleNamespace(njit=lambda function: function))
    loop = table_numba.compiled(name)
    assert loop is not None

    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("the environment is made within the time that is measured")

    monkeypatch.setattr(gym, "make", refuse)
    monkeypatch.setattr(table_numba, "transition_arrays", refuse)
    assert [loop(3), loop(4), loop(3)] == [*expected, expected[0]]

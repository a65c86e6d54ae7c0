"""Benchmarks that are compared do the same work beside what they measure."""

from typing import Any

import pytest

from qtab.bench import overhead


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

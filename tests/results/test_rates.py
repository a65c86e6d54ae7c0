"""The rates of each episode: those of the reference, and only of as many episodes as are asked for."""

from typing import Any

import numpy as np
import pytest

import qtab
from qtab.config.schedules import Exponential, Linear
from qtab.reference.parts.schedules import Schedule
from qtab.results.rates import rates
from qtab.training import progress


@pytest.mark.parametrize("warm_up", [0, 1, 7, 29])
@pytest.mark.parametrize(("value", "minimum"), [(0.7, 0.0), (0.7, 0.1), (0.7, 0.7)])
@pytest.mark.parametrize("decay", [None, 0.9, 0.3, 1.0])
def test_rates_have_the_bits_of_the_reference(decay: float | None, value: float, minimum: float, warm_up: int) -> None:
    kind = "linear" if decay is None else "exponential"
    reference, expected = Schedule(kind, value, minimum, decay, warm_up, 30), []
    for _ in range(30):
        expected.append(reference.value)
        reference.end_episode()
    schedule = Linear(value, minimum, warm_up) if decay is None else Exponential(value, minimum, decay, warm_up)
    for count in (0, 1, 8, 30):
        assert rates(schedule, 30, count).tolist() == expected[:count]


def test_a_run_that_is_stopped_early_needs_no_rates_of_later_episodes(monkeypatch: pytest.MonkeyPatch) -> None:
    counts: list[int] = []

    def counted(schedule: Any, total: int, count: int) -> np.ndarray:
        counts.append(count)
        return rates(schedule, total, count)

    def stop(progress: qtab.Progress) -> bool:
        assert progress.epsilon is not None
        assert progress.learning_rate > 0
        return progress.episodes < 40

    monkeypatch.setattr(progress, "rates", counted)
    qtab.train("FrozenLake-v1", episodes=100_000, epsilon_schedule="linear", callback=stop, callback_every=1, seed=0)
    assert max(counts) < 100
    assert len(counts) < 20  # their number doubles, so they are not computed at each call

"""Vectors of weighted features hold 64 or 1,024 numbers: runs with the most of each, and the fewest of the second."""

from typing import Any

import pytest

import qtab

CAR = "MountainCar-v0"
COUNTS: dict[int, dict[str, Any]] = {
    64: {"order": 7},
    65: {"order": 32, "coupled": False},
    1024: {"order": 31},
}
"""The options of a Fourier basis with a number of features."""


def settings_of(count: int, algorithm: str) -> dict[str, Any]:
    softmax = {"exploration": "softmax"} if algorithm == "reinforce" else {"epsilon": 0.2}
    return {
        "algorithm": algorithm,
        "discretizer": "fourier",
        "preset": None,
        "learning_rate": 0.0005,
        "seed": 5,
        "progress": False,
        **COUNTS[count],
        **softmax,
    }


@pytest.mark.parametrize("algorithm", ["sarsa", "n_step_sarsa", "reinforce"])
@pytest.mark.parametrize("count", COUNTS)
def test_a_run_is_that_of_the_reference(count: int, algorithm: str) -> None:
    settings = {**settings_of(count, algorithm), "episodes": 2, "max_episode_steps": 30}
    run = qtab.train(CAR, **settings)
    assert run.tables.shape == (1, count, 3)
    assert qtab.verify(run).equal
    assert qtab.train(CAR, **settings, backend="gymnasium").tables.tobytes() == run.tables.tobytes()


@pytest.mark.parametrize("count", COUNTS)
def test_estimates_are_those_of_the_reference(count: int) -> None:
    options: Any = {"method": "n_step_td", "n_steps": 4, "learning_rate": 0.0005, "episodes": 2}
    options |= {"discretizer": "fourier", "max_episode_steps": 30, **COUNTS[count]}
    assert qtab.estimate_values(CAR, "random", **options).verify().equal


@pytest.mark.parametrize("algorithm", ["n_step_sarsa", "reinforce"])
@pytest.mark.parametrize(("count", "limit"), [(64, 4_000_000), (65, 64_000_000), (1024, 64_000_000)])
def test_a_stored_step_takes_the_memory_of_its_capacity(count: int, limit: int, algorithm: str) -> None:
    endless = {"env_kwargs": {"goal_velocity": 1.0}, "episodes": 1, "max_episode_steps": 5000}
    settings = {**settings_of(count, algorithm), **endless}
    if algorithm == "n_step_sarsa":
        settings["n_steps"] = 5000
    assert qtab.train(CAR, **settings, memory_limit=limit).completed
    with pytest.raises(MemoryError, match=rf"would exceed memory_limit={limit // 2} "):
        qtab.train(CAR, **settings, memory_limit=limit // 2)

"""Features with weights in environments that Numba compiles: the numbers of Python, and masks."""

from typing import Any

import gymnasium as gym
import pytest

import qtab
from support.environments.own.control.mountain_car import MountainCar

FOURIER: dict[str, Any] = {"discretizer": "fourier", "order": 3, "learning_rate": 0.002, "seed": 3, "progress": False}


def limited() -> gym.Env[Any, Any]:
    return gym.wrappers.TimeLimit(MountainCar(), 200)


class Masked(MountainCar):
    """Only two of the three actions are available."""

    def action_mask(self, state: Any) -> Any:
        return [True, False, True]


def test_the_numbers_are_those_of_python_and_of_the_core() -> None:
    runs = [
        qtab.train(env, algorithm="sarsa", episodes=8, **settings, **FOURIER)
        for env, settings in (
            (limited(), {}),
            (limited(), {"backend": "gymnasium"}),
            ("MountainCar-v0", {"preset": None}),
        )
    ]
    assert [run.config.backend for run in runs] == ["rust", "gymnasium", "rust"]
    for run in runs[1:]:
        assert run.tables.tobytes() == runs[0].tables.tobytes()
        assert run.episode_returns.tobytes() == runs[0].episode_returns.tobytes()
    assert qtab.verify(runs[0], episodes=2, env=limited()).equal


def test_masks_of_the_environment_are_refused_where_they_are_asked_for() -> None:
    with pytest.raises(ValueError, match="action_mask must be False for discretizer 'fourier', got True"):
        qtab.train(Masked(), episodes=2, action_mask=True, **FOURIER)

"""Environments whose specs have a class, a function or another path as their entry point."""

from typing import Any

import gymnasium as gym
import pytest
from gymnasium.envs.classic_control import MountainCarEnv

import qtab


@pytest.mark.parametrize(
    ("entry_point", "limit"),
    [
        (MountainCarEnv, 200),
        (lambda **kwargs: MountainCarEnv(**kwargs), 200),
        ("gymnasium.envs.classic_control:MountainCarEnv", 200),
        (lambda **kwargs: gym.wrappers.TimeLimit(MountainCarEnv(**kwargs), 50), 50),
    ],
)
def test_an_environment_has_its_class_and_limit_however_it_is_made(entry_point: Any, limit: int) -> None:
    spec = gym.envs.registration.EnvSpec("MountainCar-v0", entry_point=entry_point, max_episode_steps=200)
    run = qtab.train(spec, episodes=3, seed=0)
    assert run.config.origin is not None
    described = run.config.origin.environment
    assert described is not None
    assert described.cls == "gymnasium.envs.classic_control.mountain_car:MountainCarEnv"
    assert described.max_episode_steps == limit
    assert run.config.backend == "rust"
    assert run.episode_lengths.tolist() == [limit] * 3
    in_python = qtab.train(spec, episodes=3, seed=0, backend="python")
    assert in_python.tables.tobytes() == run.tables.tobytes()

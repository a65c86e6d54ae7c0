"""Features with weights in environments that Numba compiles: the numbers of Python, resumed runs, and policies."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.environments.own.control.mountain_car import MountainCar
from support.processes.posix import posix_only
from support.processes.timer import stopped_by_a_timer

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


@posix_only
@pytest.mark.parametrize("algorithm", ["q_learning", "n_step_sarsa"])
def test_a_run_resumes_within_an_episode(algorithm: Any) -> None:
    settings = {**FOURIER, "algorithm": algorithm, "episodes": 2_000_000}
    part = stopped_by_a_timer(0.01, limited(), **settings)
    finished = len(part.episode_returns) + 2
    resumed = qtab.resume(part, env=limited(), callback=lambda _: False, callback_every=finished, progress=False)
    whole = qtab.train(limited(), callback=lambda _: False, callback_every=finished, **settings)
    for name in ("tables", "episode_returns", "episode_lengths"):
        assert getattr(resumed, name).tobytes() == getattr(whole, name).tobytes(), name


def test_a_learned_policy_is_evaluated_as_that_of_the_core() -> None:
    ours = qtab.train(limited(), algorithm="sarsa", episodes=30, **FOURIER)
    core = qtab.train("MountainCar-v0", algorithm="sarsa", episodes=30, preset=None, **FOURIER)
    played = qtab.evaluate(ours, 4, seed=1, env=limited()).returns
    assert played.tobytes() == qtab.evaluate(core, 4, seed=1).returns.tobytes()
    arguments: Any = {"seeds": 1, "episodes": 3, "discretizer": "tiles"}
    values = [
        qtab.estimate_values(env, lambda seen: ours.predict(seen)[0], **arguments).weights
        for env in (limited(), "MountainCar-v0")
    ]
    assert values[0].tobytes() == values[1].tobytes()
    assert np.any(values[0])


def test_masks_of_the_environment_are_refused_where_they_are_asked_for() -> None:
    with pytest.raises(ValueError, match="action_mask must be False for discretizer 'fourier', got True"):
        qtab.train(Masked(), episodes=2, action_mask=True, **FOURIER)

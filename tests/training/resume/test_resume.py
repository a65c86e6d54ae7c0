"""A run that is stopped, saved and resumed equals the uninterrupted one, bit for bit."""

import logging
from collections.abc import Callable
from typing import Any, get_args

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.callbacks import Checkpoint
from qtab.config.choices import Algorithm
from support.environments.gridworld import Room, StoppedError, StoppingRoom
from support.learners.learner_settings import run_settings
from support.parity import assert_same_run, run_of
from support.processes.posix import posix_only
from support.processes.timer import stopped_by_a_timer


def stopped(env: Any, after: int, **config: Any) -> qtab.Run:
    """A run that a callback stopped after so many episodes."""
    return qtab.train(env, callback=until(after), callback_every=after, **config)


def until(episodes: int) -> Callable[[qtab.Progress], bool]:
    """A callback that stops a run after so many episodes."""
    return lambda progress: progress.episodes < episodes


def assert_resumed(resumed: qtab.Run, whole: qtab.Run) -> None:
    assert_same_run(resumed, whole)
    assert resumed.state == whole.state
    assert resumed.completed


PROFILE: Any = settings.default


@pytest.mark.parametrize("algorithm", get_args(Algorithm))
@settings(max_examples=PROFILE.max_examples // 10)  # each resumes twice: the run, and the one that was saved
@given(data=st.data())
def test_every_learner_resumes_between_episodes(algorithm, tmp_path_factory, data):
    config = data.draw(run_settings(algorithm))
    episodes = config["episodes"]
    after = data.draw(st.integers(1, episodes))
    whole = qtab.train("MountainCar-v0", **config)
    part = stopped("MountainCar-v0", after, **config)
    path = tmp_path_factory.getbasetemp() / f"{algorithm}.npz"
    part.save(path)
    for stored in (part, qtab.load(path)):
        if stored.completed:
            assert qtab.resume(stored) is stored
        else:
            assert_resumed(qtab.resume(stored), whole)


LONG: dict[str, dict[str, Any]] = {
    "Acrobot-v1": {"algorithm": "true_online_sarsa_lambda", "discretizer": "tiles", "tiles": 3, "tilings": 8},
    "CartPole-v1": {
        "algorithm": "sarsa_lambda",
        "discretizer": "tiles",
        "low": (-2.4, -3, -0.21, -3),
        "high": (2.4, 3, 0.21, 3),
    },
    "Pendulum-v1": {"algorithm": "n_step_sarsa", "actions": 3, "discretizer": "bins", "bins": 5},
    "MountainCarContinuous-v0": {"algorithm": "watkins_q_lambda", "actions": 3, "tiles": 8},
    "Taxi-v4": {"algorithm": "dyna_q_plus", "env_kwargs": {"fickle_passenger": True}},
    "Blackjack-v1": {"algorithm": "double_q_learning"},
}


@posix_only
@pytest.mark.parametrize("env", LONG)
@pytest.mark.parametrize("bit_generator", ["PCG64", "MT19937"])
def test_a_run_stopped_in_the_middle_of_an_episode_resumes_exactly(env, bit_generator):
    config = {"episodes": 2_000_000, "max_episode_steps": 1000, "seed": 3, "bit_generator": bit_generator, **LONG[env]}
    config["visits"] = True
    part = stopped_by_a_timer(0.03, env, **config)
    finished = len(part.episode_returns)
    part = qtab.resume(part, callback=until(finished + 20), callback_every=20, snapshots=[finished + 1])
    whole = stopped(env, len(part.episode_returns), snapshots=[finished + 1], **config)
    assert_same_run(part, whole)
    assert part.visits is not None
    np.testing.assert_array_equal(part.visits, whole.visits)
    assert part.snapshots is not None
    assert whole.snapshots is not None
    assert part.snapshots.tables.tobytes() == whole.snapshots.tables.tobytes()


STEPS = [one for one in get_args(Algorithm) if one != "gradient_bandit"]
"""The algorithms whose episodes have several steps."""


def check_within(env: str, seconds: float, **config: Any) -> None:
    """Stops a run after so much time, and compares it some episodes later with an uninterrupted one."""
    part = stopped_by_a_timer(seconds, env, **config)
    finished = len(part.episode_returns) + 2
    resumed = qtab.resume(part, callback=until(finished), callback_every=finished)
    assert_same_run(resumed, stopped(env, finished, **config))


@posix_only
@pytest.mark.parametrize("time_aware", [False, True])
@pytest.mark.parametrize("algorithm", STEPS)
def test_every_learner_resumes_within_an_episode(algorithm, time_aware, caplog):
    config = {"algorithm": algorithm, "time_aware": time_aware, "discretizer": "bins", "bins": 4, "seed": 5}
    check_within("MountainCar-v0", 0.005, episodes=2_000_000, max_episode_steps=50, **config)
    assert "stopped within" not in caplog.text


@posix_only
@pytest.mark.parametrize("seconds", [0.002, 0.01, 0.03])
@pytest.mark.parametrize(
    "config",
    [
        {"algorithm": "n_step_sarsa", "n_steps": 4000, "max_episode_steps": 4100},
        {"algorithm": "monte_carlo", "max_episode_steps": 20_000},
        {"algorithm": "reinforce", "max_episode_steps": 20_000},
    ],
    ids=lambda config: config["algorithm"],
)
def test_a_run_that_learns_from_an_episode_at_its_time_limit_resumes_exactly(config, seconds):
    space: dict[str, Any] = {"discretizer": "bins", "bins": 2, "env_kwargs": {"goal_velocity": 1.0}}
    check_within("MountainCar-v0", seconds, episodes=10**6, time_aware=True, seed=3, **space, **config)


@pytest.mark.parametrize("algorithm", STEPS)
def test_an_environment_stepped_in_python_resumes_with_its_next_episode_and_says_so(algorithm, caplog):
    config: dict[str, Any] = {"algorithm": algorithm, "seed": 4, "episodes": 8, "max_episode_steps": 20}
    whole = qtab.train(StoppingRoom(), **config)
    finished = 3
    steps = int(whole.episode_lengths[:finished].sum())
    for stopping in (StoppingRoom(steps + 1), StoppingRoom(steps + 5), StoppingRoom(resets=finished + 1)):
        with pytest.raises(StoppedError) as caught:
            qtab.train(stopping, **config)
        part = run_of(caught.value)
        assert len(part.episode_returns) == finished
        assert "stopped within" not in caplog.text
        resumed = qtab.resume(part, env=StoppingRoom())
        assert resumed.completed
        assert resumed.episode_returns[:finished].tobytes() == whole.episode_returns[:finished].tobytes()
        assert f"the run was stopped within episode {finished} (counted from 0)" in caplog.text
        caplog.clear()
    assert_resumed(qtab.resume(stopped(StoppingRoom(), finished, **config), env=StoppingRoom()), whole)
    assert "stopped within" not in caplog.text


def test_whatever_the_state_raises_the_exception_of_the_user_carries_the_run(caplog, monkeypatch):
    class Broken(StoppingRoom):
        @property
        def np_random(self) -> Any:
            if self.steps_left <= 0:
                raise ZeroDivisionError("no generator")
            return super().np_random

        @np_random.setter
        def np_random(self, generator: Any) -> None:
            self._np_random = generator

    with pytest.raises(StoppedError) as caught:
        qtab.train(Broken(60), seed=4, episodes=40, max_episode_steps=20)
    run = run_of(caught.value)
    assert len(run.episode_returns) >= 2
    assert run.state is None
    assert "cannot be resumed: its state could not be read (ZeroDivisionError: no generator)" in caplog.text
    with pytest.raises(ValueError, match="run must have the state of its training"):
        qtab.resume(run, env=Broken())


def test_more_episodes_spread_the_schedules_over_all_of_them(caplog):
    part = qtab.train("MountainCar-v0", seed=0, episodes=30)
    with caplog.at_level(logging.WARNING, "qtab"):
        longer = qtab.resume(part, 50)
    assert "epsilon now falls linearly over 50 episodes instead of 30" in caplog.text
    assert longer.config.episodes == 50
    assert longer.episode_returns[:30].tobytes() == part.episode_returns.tobytes()
    assert len(longer.episode_returns) == 50
    constant: dict[str, Any] = {"seed": 0, "epsilon_schedule": "constant", "epsilon": 0.2}
    caplog.clear()
    longer = qtab.resume(qtab.train("MountainCar-v0", episodes=30, **constant), 50)
    assert_resumed(longer, qtab.train("MountainCar-v0", episodes=50, **constant))
    assert not caplog.text


@pytest.mark.parametrize("env", ["FrozenLake-v1", "CartPole-v1"])
def test_an_environment_stepped_in_python_resumes_between_episodes(env, tmp_path):
    config: dict[str, Any] = {"backend": "gymnasium", "seed": 4, "episodes": 40}
    part = stopped(env, 13, **config)
    part.save(tmp_path / "run.npz")
    assert_resumed(qtab.resume(tmp_path / "run.npz"), qtab.train(env, **config))


def test_an_environment_without_an_id_is_given_again():
    config: dict[str, Any] = {"seed": 4, "episodes": 40}
    part = stopped(Room(), 13, **config)
    with pytest.raises(gym.error.Error):
        qtab.resume(part)
    assert_resumed(qtab.resume(part, env=Room()), qtab.train(Room(), **config))


def test_a_resumed_run_may_be_stopped_and_resumed_again():
    config: dict[str, Any] = {"seed": 4, "episodes": 60, "algorithm": "sarsa_lambda"}
    part = stopped("MountainCar-v0", 10, **config)
    for episodes in (20, 30, 40):
        part = qtab.resume(part, callback=until(episodes), callback_every=10)
        assert len(part.episode_returns) == episodes
    assert_resumed(qtab.resume(part), qtab.train("MountainCar-v0", **config))


def test_a_run_that_does_not_fit_into_memory_is_refused_before_anything_is_logged(caplog):
    run = qtab.train("MountainCar-v0", seed=0, episodes=5)
    for call in (lambda: qtab.resume(run, 10**12), lambda: qtab.train(resume=run, episodes=10**12)):
        with pytest.raises(MemoryError, match="1,000,000,000,000 episodes would take"):
            call()
    assert caplog.messages == []
    qtab.resume(run, 6)
    assert "epsilon now falls linearly over 6 episodes instead of 5" in caplog.text


def test_a_run_that_has_finished_is_returned_as_it_is_and_a_message_says_so(tmp_path, caplog):
    path = tmp_path / "checkpoint.npz"

    def program():
        resume = path if path.exists() else None
        return qtab.train("MountainCar-v0", seed=0, episodes=6, resume=resume, callback=Checkpoint(path, every=4))

    whole = program()
    assert caplog.messages == []
    assert_same_run(program(), whole)
    assert caplog.messages == ["the run has finished its 6 episodes: there is nothing to train"]
    for call in (lambda: qtab.resume(whole), lambda: qtab.resume(whole, 6), lambda: qtab.train(resume=whole)):
        assert call() is whole
    of_many = qtab.train_many("MountainCar-v0", seeds=2, episodes=5, tables=True)[0]  # which cannot be resumed
    assert qtab.train("MountainCar-v0", resume=of_many) is of_many
    with pytest.raises(ValueError, match="seed must be that of the run to resume, 0, got 1"):
        qtab.train("MountainCar-v0", seed=1, episodes=6, resume=path)
    with pytest.raises(TypeError, match="episodes must be an integer"):
        qtab.resume(whole, 6.0)  # type: ignore[arg-type]


def test_what_cannot_be_resumed_is_refused_by_name(tmp_path):
    run = qtab.train("MountainCar-v0", seed=0, episodes=5)
    for call, message in {
        lambda: qtab.resume(run, 4): "episodes must be more than the 5 that the run has finished, got 4",
        lambda: qtab.resume(run, snapshots=[3]): "snapshots must",
        lambda: qtab.resume(
            qtab.train_many("MountainCar-v0", seeds=2, episodes=5, tables=True)[0], 9
        ): "runs of train_many",
    }.items():
        with pytest.raises(ValueError, match=message):
            call()
    with pytest.raises(TypeError, match="run must be a Run or the path of a saved run, got 3"):
        qtab.resume(3)  # type: ignore[arg-type]
    with pytest.raises(FileNotFoundError):
        qtab.resume(tmp_path / "none.npz")

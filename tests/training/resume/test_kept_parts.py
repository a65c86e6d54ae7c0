"""What ``resume`` continues beside the table: visits and snapshots; and ``train(..., resume=)``, which is the same."""

import inspect
import logging
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.callbacks import Checkpoint
from support.environments.gridworld import Room
from support.files.run_files import members_of, with_header, with_right_digest, write_members
from support.parity import assert_same_run, run_of

CAR = "MountainCar-v0"
LAKE: dict[str, Any] = {"seed": 0, "episodes": 20, "visits": True, "snapshots": [0, 3, 7, 12, 20]}


def until(episodes: int) -> Callable[[qtab.Progress], bool]:
    return lambda progress: progress.episodes < episodes


def stopped(after: int, env: Any = "FrozenLake-v1", **config: Any) -> qtab.Run:
    return qtab.train(env, callback=until(after), callback_every=after, **config)


def snapshots_of(run: qtab.Run) -> qtab.Snapshots:
    assert run.snapshots is not None
    return run.snapshots


def assert_same_arrays(one: qtab.Run, other: qtab.Run) -> None:
    """Asserts that two runs are equal in all that they hold, except for the time that they took."""
    assert_same_run(one, other)
    assert one.config == other.config
    assert one.state == other.state
    assert (one.visits is None) == (other.visits is None)
    if one.visits is not None and other.visits is not None:
        assert one.visits.tobytes() == other.visits.tobytes()
    assert (one.snapshots is None) == (other.snapshots is None)
    if one.snapshots is not None and other.snapshots is not None:
        assert one.snapshots.episodes.tolist() == other.snapshots.episodes.tolist()
        assert one.snapshots.tables.tobytes() == other.snapshots.tables.tobytes()


@given(data=st.data())
@settings(max_examples=max(1, settings().max_examples // 4))
def test_visits_and_snapshots_are_those_of_the_uninterrupted_run(data, tmp_path_factory):
    episodes = data.draw(st.integers(2, 25))
    asked = data.draw(st.none() | st.integers(1, 30) | st.sets(st.integers(0, episodes), min_size=1).map(sorted))
    config: dict[str, Any] = {"seed": data.draw(st.integers(0, 99)), "episodes": episodes}
    config |= {"visits": data.draw(st.booleans()), "snapshots": asked}
    config |= data.draw(
        st.sampled_from(
            [{}, {"algorithm": "n_step_sarsa"}, {"algorithm": "double_q_learning"}, {"backend": "gymnasium"}]
        )
    )
    whole = qtab.train("FrozenLake-v1", **config)
    part = stopped(data.draw(st.integers(1, episodes - 1)), **config)
    for _ in range(data.draw(st.integers(0, 2))):
        if len(part.episode_returns) + 1 < episodes:
            after = data.draw(st.integers(len(part.episode_returns) + 1, episodes - 1))
            part = qtab.resume(part, callback=until(after), callback_every=after)
    path = tmp_path_factory.mktemp("part") / "run.npz"
    part.save(path)
    given_as = data.draw(st.sampled_from([part, path, str(path)]))
    resume: Any = data.draw(st.sampled_from([qtab.resume, lambda run: qtab.train("FrozenLake-v1", resume=run)]))
    assert_same_arrays(resume(given_as), whole)


def test_a_checkpoint_of_a_killed_run_takes_the_snapshots_that_were_left(tmp_path):
    class KilledError(Exception):
        pass

    def kill(progress: qtab.Progress) -> None:
        if progress.episodes == 9:
            raise KilledError

    callbacks: list[Any] = [Checkpoint(tmp_path / "run.npz", every=6), kill]
    with pytest.raises(KilledError) as caught:
        qtab.train("FrozenLake-v1", callback=callbacks, callback_every=9, **LAKE)
    assert snapshots_of(qtab.load(tmp_path / "run.npz")).episodes.tolist() == [0, 3]
    assert snapshots_of(run_of(caught.value)).episodes.tolist() == [0, 3, 7]
    whole = qtab.train("FrozenLake-v1", **LAKE)
    assert_same_arrays(qtab.resume(tmp_path / "run.npz"), whole)
    assert_same_arrays(qtab.resume(run_of(caught.value)), whole)


def test_an_exception_in_the_resumed_part_keeps_the_earlier_snapshots():
    def fail(_: qtab.Progress) -> None:
        raise ValueError("enough")

    with pytest.raises(ValueError, match="enough") as caught:
        qtab.resume(stopped(4, **LAKE), callback=fail, callback_every=8)
    assert snapshots_of(run_of(caught.value)).episodes.tolist() == [0, 3, 7]


def test_more_snapshots_can_be_asked_for_of_what_is_left():
    part = stopped(8, seed=0, episodes=20, snapshots=[3, 12])
    assert snapshots_of(qtab.resume(part, snapshots=5)).episodes.tolist() == [3, 12, 16, 20]
    assert snapshots_of(qtab.resume(part, 40, snapshots=[3, 30])).episodes.tolist() == [3, 12, 30]
    assert snapshots_of(qtab.resume(part, 10)).episodes.tolist() == [3]
    with pytest.raises(ValueError, match=r"^snapshots must lie after the 8 episodes that the run has finished, got 7$"):
        qtab.resume(part, snapshots=[7, 12])
    without = stopped(8, seed=0, episodes=20)
    assert qtab.resume(without).snapshots is None
    assert snapshots_of(qtab.resume(without, snapshots=[9, 20])).episodes.tolist() == [9, 20]


@pytest.mark.parametrize(
    ("value", "message"),
    [([7, 7], "ascending"), ([-1], "list of episodes"), ({}, "list of episodes"), ([True], "list of episodes")],
)
def test_a_file_with_impossible_snapshots_to_take_is_refused(tmp_path, value, message):
    stopped(8, **LAKE).save(tmp_path / "run.npz")
    members = with_header(members_of(tmp_path / "run.npz"), lambda header: header.update(snapshots=value))
    write_members(tmp_path / "run.npz", with_right_digest(members))
    with pytest.raises(ValueError, match=f"its snapshots to be taken .*{message}"):
        qtab.load(tmp_path / "run.npz")


SAME: dict[str, Any] = {
    "nothing": lambda: {},
    "all settings": lambda: {"env": CAR, "seed": 3, "episodes": 30, "preset": "article", "learning_rate": 0.3},
    "the config": lambda: {"config": {"seed": np.int64(3), "env": CAR}},
    "another number of episodes": lambda: {"seed": 3, "episodes": np.int32(30)},
    "settings that are not given": lambda: {"seed": None, "preset": None, "actions": None},
    "a spec": lambda: {"env": gym.spec(CAR)},
    "an environment": lambda: {"env": gym.make(CAR)},
}


@pytest.mark.parametrize("same", SAME.values(), ids=SAME)
def test_train_resumes_with_the_settings_of_the_run(same):
    whole = qtab.train(CAR, seed=3, episodes=30, learning_rate=0.3, visits=True)
    part = stopped(11, CAR, seed=3, episodes=30, learning_rate=0.3, visits=True)
    assert_same_arrays(qtab.train(**same(), resume=part, visits=True, callback=print, callback_every=50), whole)
    assert_same_arrays(qtab.train(config=whole.config, resume=part), whole)


def test_train_resumes_on_ones_own_environment_and_with_its_keyword_arguments():
    whole = qtab.train(Room(), seed=4, episodes=12)
    assert_same_arrays(qtab.train(Room(), resume=stopped(5, Room(), seed=4, episodes=12)), whole)
    fast = {"goal_velocity": 0.02}
    whole = qtab.train(CAR, env_kwargs=fast, seed=0, episodes=9)
    part = stopped(5, CAR, env_kwargs=fast, seed=0, episodes=9)
    for env in (None, CAR, gym.make(CAR, goal_velocity=0.02)):
        assert_same_arrays(qtab.train(env, resume=part), whole)
    assert_same_arrays(qtab.resume(part, env=gym.make(CAR, goal_velocity=0.02)), whole)


OTHER: list[tuple[dict[str, Any], str]] = [
    ({"seed": 4}, "seed must be that of the run to resume, 3, got 4: of the settings, only episodes may change"),
    ({"learning_rate": 0.5}, "learning_rate must be that of the run to resume, 0.2, got 0.5"),
    ({"config": {"discount": 0.95}}, "discount must be that of the run to resume, 0.9, got 0.95"),
    ({"preset": "solved"}, "preset must be that of the run to resume, 'article', got 'solved'"),
    ({"algorithm": "sarsa_lambda"}, "algorithm must be that of the run to resume, 'q_learning', got 'sarsa_lambda'"),
    ({"env": "Taxi-v4"}, "env must be that of the run to resume, 'MountainCar-v0', got 'Taxi-v4'"),
    ({"env": f"qtab/{CAR}"}, "env must be that of the run to resume"),
    ({"env": Room()}, "env must be that of the run to resume, 'MountainCar-v0', got 'Room'"),
    ({"env": gym.make(CAR, goal_velocity=0.1)}, "env_kwargs must be that of the run to resume, {}, got {"),
    ({"env_kwargs": {"goal_velocity": 0.1}}, "env_kwargs must be that of the run to resume, {}, got {"),
    ({"trace_decay": 0.5}, "trace_decay applies to"),
    ({"visits": True}, "visits must be False: the run to resume did not count the visits of its first episodes"),
    ({"episodes": 8}, "episodes must be more than the 8 that the run has finished, got 8"),
    ({"snapshots": [5]}, "snapshots must lie after the 8 episodes that the run has finished, got 5"),
]


@pytest.mark.parametrize(("other", "message"), OTHER, ids=[next(iter(other)) for other, _ in OTHER])
def test_train_refuses_another_setting_by_name(other, message):
    part = stopped(8, CAR, seed=3, episodes=12)
    with pytest.raises(ValueError) as caught:
        qtab.train(**other, resume=part)
    assert str(caught.value).startswith(message)


OTHER_ENV: list[tuple[Callable[[], gym.Env], str]] = [
    (lambda: gym.make("Taxi-v4"), "env must be that of the run to resume, 'MountainCar-v0', got 'Taxi-v4'"),
    (Room, "env must be that of the run to resume, 'MountainCar-v0', got 'Room'"),
    (
        lambda: gym.make(CAR, goal_velocity=0.1),
        "env_kwargs must be that of the run to resume, {}, got {'goal_velocity': 0.1}",
    ),
    (lambda: gym.make(CAR, max_episode_steps=50), "max_episode_steps must be that of the run to resume, 200, got 50"),
]


@pytest.mark.parametrize(("make", "message"), OTHER_ENV, ids=["id", "class", "keyword arguments", "time limit"])
def test_another_environment_is_refused_by_name(make, message):
    env = make()
    part = stopped(8, CAR, seed=3, episodes=12)
    for call in (lambda: qtab.resume(part, env=env), lambda: qtab.train(env, resume=part)):
        with pytest.raises(ValueError) as caught:
            call()
        assert str(caught.value) == f"{message}: of the settings, only episodes may change"


def test_the_environment_of_the_run_may_be_given_with_its_id():
    for limit, of_env in ((None, None), (50, 50), (300, 300), (50, 200)):
        part = stopped(8, CAR, seed=3, episodes=12, max_episode_steps=limit)
        whole = qtab.train(CAR, seed=3, episodes=12, max_episode_steps=limit)
        env = gym.make(CAR) if of_env is None else gym.make(CAR, max_episode_steps=of_env)
        assert_same_arrays(qtab.resume(part, env=env), whole)


def test_train_refuses_what_is_no_run_by_name(tmp_path):
    with pytest.raises(TypeError, match=r"^resume must be a Run or the path of a saved run, got 3$"):
        qtab.train(CAR, resume=3)  # type: ignore[arg-type]
    with pytest.raises(FileNotFoundError):
        qtab.train(CAR, resume=tmp_path / "none.npz")
    runs = qtab.train_many(CAR, seeds=1, episodes=2, tables=True)
    with pytest.raises(ValueError, match=r"^resume must have the state of its training"):
        qtab.train(resume=runs[0], episodes=3)


def test_train_says_that_a_schedule_is_spread_anew(caplog):
    part = qtab.train(CAR, seed=0, episodes=5)
    with caplog.at_level(logging.WARNING, "qtab"):
        longer = qtab.train(resume=part, episodes=7)
    assert "epsilon now falls linearly over 7 episodes instead of 5" in caplog.text
    assert_same_arrays(longer, qtab.resume(part, 7))


def test_help_explains_resume():
    assert inspect.signature(qtab.train).parameters["resume"].default is None
    assert "resume: A run that was stopped early" in (inspect.getdoc(qtab.train) or "")

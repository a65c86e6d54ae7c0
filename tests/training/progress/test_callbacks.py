"""A callback receives the progress, can stop the run, and can fail without losing what was learned."""

from itertools import pairwise

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab import _core
from qtab.reference import q_learning
from qtab.training.setup.resolve import resolve
from support.parity import assert_same_run

BACKENDS = ["rust", "gymnasium"]


def train(**settings):
    return qtab.train("MountainCar-v0", **{"seed": 6, "episodes": 10, "max_episode_steps": 30} | settings)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("every", "calls"),
    [(1, list(range(1, 11))), (3, [3, 6, 9, 10]), (5, [5, 10]), (10, [10]), (99, [10]), (10**30, [10])],
)
def test_a_callback_is_called_every_so_many_episodes_and_after_the_last(backend, every, calls):
    seen: list[qtab.Progress] = []
    run = train(backend=backend, callback=seen.append, callback_every=every)
    assert [progress.episodes for progress in seen] == calls
    for progress in seen:
        assert progress.total == 10
        assert progress.returns.tobytes() == run.episode_returns[: progress.episodes].tobytes()
        assert progress.lengths.tobytes() == run.episode_lengths[: progress.episodes].tobytes()


def test_a_callback_cannot_change_what_later_ones_receive():
    seen: list[qtab.Progress] = []

    def overwrite(progress: qtab.Progress) -> None:
        for column in (progress.returns, progress.lengths):
            with pytest.raises(ValueError, match="read-only"):
                column[:] = 0

    run = train(callback=[overwrite, seen.append], callback_every=5)
    for progress in seen:
        assert progress.returns.tolist() == run.episode_returns[: progress.episodes].tolist()
        assert progress.lengths.tolist() == run.episode_lengths[: progress.episodes].tolist()
    assert_same_run(run, train())


def test_a_callback_is_called_every_hundred_episodes_by_default():
    seen = []
    train(episodes=250, callback=lambda progress: seen.append(progress.episodes))
    assert seen == [100, 200, 250]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_callback_does_not_change_the_run(backend):
    assert_same_run(train(backend=backend), train(backend=backend, callback=lambda progress: True, callback_every=1))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("no", [False, np.False_, 0])
def test_returning_false_stops_the_run_and_returns_its_prefix(backend, no):
    run = train(backend=backend, callback=lambda progress: no if progress.episodes == 6 else None, callback_every=2)
    assert run.completed is False
    assert len(run.episode_returns) == 6
    # The schedule is that of the full ten episodes.
    table, returns, lengths = q_learning(gym.make("MountainCar-v0", max_episode_steps=30), run.config, stop_after=6)
    assert run.config.episodes == 10
    assert run.q_table.tobytes() == table.tobytes()
    assert run.episode_returns.tobytes() == returns.tobytes()
    assert run.episode_lengths.tobytes() == lengths.tobytes()


@pytest.mark.parametrize("yes", [True, None, np.True_, 1])
def test_any_other_value_continues_the_run(yes):
    assert train(callback=lambda progress: yes, callback_every=1).completed is True


def test_false_after_the_last_episode_is_too_late_to_stop():
    assert train(callback=lambda progress: False, callback_every=10).completed is True


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("raised", [RuntimeError("enough"), KeyboardInterrupt(), SystemExit(3), StopIteration()])
def test_an_exception_in_a_callback_carries_the_run_so_far(backend, raised):
    def fail(progress):
        if progress.episodes == 4:
            raise raised

    with pytest.raises(type(raised)) as caught:
        train(backend=backend, callback=fail, callback_every=2)
    assert caught.value is raised
    run = raised.run
    assert run.completed is False
    assert_same_run(run, train(backend=backend, callback=lambda progress: progress.episodes < 4, callback_every=2))


def test_a_callback_may_train():
    inner = []
    outer = train(callback=lambda progress: inner.append(train(seed=1)), callback_every=5)
    assert_same_run(outer, train())
    assert_same_run(inner[0], inner[1])


def test_progress_reads_only_new_episodes_and_seldom_moves_the_others():
    seen: list[qtab.Progress] = []
    train(episodes=64, callback=seen.append, callback_every=1)
    moves = sum(not np.shares_memory(after.returns, before.returns) for before, after in pairwise(seen))
    assert moves == 6  # at 2, 3, 5, 9, 17 and 33 episodes: the capacity doubles


def test_a_trainer_lists_the_episodes_since_a_given_one():
    resolved = resolve("MountainCar-v0", {"seed": 6, "episodes": 10, "max_episode_steps": 30})
    trainer = _core.Trainer(resolved.spec(), resolved.seed)
    trainer.advance(10)
    every = trainer.episodes()
    for since in (0, 4, 10, 11):
        for some, all_of_them in zip(trainer.episodes(since=since), every, strict=True):
            assert some.tobytes() == all_of_them[since:].tobytes()


def test_a_callback_that_cannot_be_called_is_refused_by_name() -> None:
    with pytest.raises(TypeError, match=r"^callback must be callable, got 3$"):
        qtab.train("MountainCar-v0", episodes=1, callback=3)  # type: ignore[arg-type]

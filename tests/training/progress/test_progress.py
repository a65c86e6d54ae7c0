"""What a callback can read: the tables, the rates and the run at the time of its call."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.config.choices import CHOICES
from support.learners.learner_settings import run_settings
from support.parity import assert_same_run

ALGORITHMS = sorted(CHOICES["algorithm"])
SHORT: dict[str, Any] = {"seed": 6, "episodes": 10, "max_episode_steps": 30}


def read_everything(progress: qtab.Progress) -> None:
    """Fills in everything that is read on demand."""
    _ = progress.tables, progress.run, progress.epsilon, progress.learning_rate, progress.steps, progress.seconds


@given(data=st.data(), every=st.integers(1, 3))
@settings(max_examples=settings().max_examples // 2)
def test_a_callback_reads_the_run_as_it_would_be_if_it_stopped_there(data, every):
    algorithm = data.draw(st.sampled_from(ALGORITHMS))
    chosen = data.draw(run_settings(algorithm))
    seen: list[qtab.Progress] = []

    def look(progress: qtab.Progress) -> None:
        read_everything(progress)
        seen.append(progress)

    whole = qtab.train("MountainCar-v0", callback=look, callback_every=every, **chosen)
    assert_same_run(whole, qtab.train("MountainCar-v0", **chosen))
    for progress in seen:
        stop = {"callback": lambda now, at=progress.episodes: now.episodes < at, "callback_every": every}
        stopped = qtab.train("MountainCar-v0", **stop, **chosen)
        assert_same_run(progress.run, stopped)
        assert progress.tables.tobytes() == stopped.tables.tobytes()
        assert progress.run.completed is (progress.episodes == whole.config.episodes)
        assert progress.steps == stopped.episode_lengths.sum()
        assert progress.episode == progress.episodes - 1
        assert progress.config == whole.config


@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
def test_the_q_table_is_that_of_the_run(backend):
    seen: list[np.ndarray] = []
    for algorithm in ("q_learning", "double_q_learning"):
        run = qtab.train(
            "MountainCar-v0", algorithm=algorithm, backend=backend, callback=lambda p: seen.append(p.q_table), **SHORT
        )
        assert seen[-1].shape == (19, 15, 3)
        assert seen[-1].tobytes() == run.q_table.tobytes()


def test_the_q_table_of_tile_coding_is_refused_as_that_of_a_run():
    def look(progress):
        _ = progress.q_table

    with pytest.raises(ValueError, match="q_table needs cells, which discretizer 'tiles' does not have"):
        qtab.train("MountainCar-v0", callback=look, preset="solved", **SHORT)


@pytest.mark.parametrize("name", ["run", "tables", "q_table"])
def test_what_was_not_read_during_the_call_cannot_be_read_afterwards(name):
    seen: list[qtab.Progress] = []

    def look(progress):
        assert progress.is_current
        if progress.episodes == 2:
            getattr(progress, name)
        seen.append(progress)

    qtab.train("MountainCar-v0", callback=look, callback_every=1, **SHORT)
    early = getattr(seen[1], name)  # read during the call: still what it was then
    assert early is getattr(seen[1], name)
    with pytest.raises(RuntimeError, match=rf"^progress\.{name} must be read during the call: .* since its 1 episode$"):
        getattr(seen[0], name)
    with pytest.raises(RuntimeError, match=r"since its 10 episodes$"):
        getattr(seen[-1], name)
    assert not any(progress.is_current for progress in seen)


def test_a_progress_kept_beyond_an_interruption_does_not_show_a_later_table():
    seen: list[qtab.Progress] = []

    class Stop(qtab.callbacks.BaseCallback):
        def __call__(self, progress):
            if progress.episodes == 4:
                raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        qtab.train("MountainCar-v0", callback=[seen.append, Stop(every=4)], callback_every=3, **SHORT)
    with pytest.raises(RuntimeError, match="since its 3 episodes"):
        _ = seen[0].run


def test_the_copies_belong_to_the_callback():
    def scribble(progress):
        progress.tables[:] = 7.0
        progress.q_table[:] = 8.0
        progress.run.tables[:] = 9.0

    run = qtab.train("MountainCar-v0", callback=scribble, callback_every=1, **SHORT)
    assert_same_run(run, qtab.train("MountainCar-v0", **SHORT))


def rates(**chosen: Any) -> list[tuple[float | None, float]]:
    seen: list[tuple[float | None, float]] = []
    qtab.train(
        "MountainCar-v0",
        callback=lambda progress: seen.append((progress.epsilon, progress.learning_rate)),
        callback_every=1,
        **{**SHORT, **chosen},
    )
    return seen


def test_the_rates_are_those_of_the_last_finished_episode():
    linear = rates(epsilon=0.8, min_epsilon=0.0, learning_rate=0.5)
    assert linear[0] == (0.8, 0.5)
    assert [epsilon for epsilon, _ in linear] == pytest.approx([0.8 - 0.08 * episode for episode in range(10)])
    assert {rate for _, rate in linear} == {0.5}
    halved = rates(
        epsilon=0.1,
        epsilon_schedule="constant",
        learning_rate=1.0,
        learning_rate_schedule="exponential",
        learning_rate_decay=0.5,
        min_learning_rate=0.1,
        learning_rate_warm_up=1,
    )
    assert halved[:6] == [(0.1, rate) for rate in (1.0, 1.0, 0.5, 0.25, 0.125, 0.1)]


def test_the_rates_have_the_bits_of_the_learners():
    value = 0.8
    for episode, (epsilon, _) in enumerate(rates(epsilon=0.8, min_epsilon=0.03, episodes=500, max_episode_steps=1)):
        assert epsilon == value, episode
        value -= (0.8 - 0.03) / 500  # not 0.8 - episode * ..., which rounds differently


def test_softmax_has_no_epsilon():
    assert rates(exploration="softmax", temperature=1.0)[-1] == (None, 0.2)


def test_reading_the_rates_of_an_earlier_progress_works():
    seen: list[qtab.Progress] = []
    qtab.train("MountainCar-v0", callback=seen.append, callback_every=1, **SHORT)
    backwards = [progress.epsilon for progress in reversed(seen)]
    assert backwards == [epsilon for epsilon, _ in reversed(rates())]


def test_seconds_grow():
    seen: list[float] = []
    run = qtab.train("MountainCar-v0", callback=lambda p: seen.append(p.seconds), callback_every=1, **SHORT)
    assert seen == sorted(seen)
    assert 0.0 <= seen[0] <= seen[-1] <= run.seconds


@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
def test_a_run_that_is_read_meanwhile_keeps_its_recordings(backend):
    runs: list[qtab.Run] = []
    chosen: dict[str, Any] = {**SHORT, "backend": backend, "record": 3}
    run = qtab.train("MountainCar-v0", callback=lambda p: runs.append(p.run), callback_every=4, **chosen)
    alone = qtab.train("MountainCar-v0", **chosen)
    assert_same_run(run, alone)
    assert [recording.episode for recording in run.recordings] == [7, 8, 9]
    assert [recording.actions for recording in run.recordings] == [recording.actions for recording in alone.recordings]
    assert [so_far.recordings for so_far in runs] == [(), (), ()]


def test_a_progress_of_ones_own_has_the_fields_that_were_given():
    progress = qtab.Progress(2, 10, np.array([-3.0, -4.0]), np.array([3, 4]))
    assert (progress.episode, progress.steps) == (1, 7)
    with pytest.raises(RuntimeError, match="was not made by"):
        _ = progress.run


def test_nothing_is_copied_unless_it_is_read(monkeypatch):
    from qtab.training import train as module

    made: list[object] = []
    real = module._run

    def count(*arguments, **keywords):
        made.append(keywords)
        return real(*arguments, **keywords)

    monkeypatch.setattr(module, "_run", count)
    qtab.train("MountainCar-v0", callback=lambda progress: progress.episode >= 0, callback_every=1, **SHORT)
    assert len(made) == 1  # the result

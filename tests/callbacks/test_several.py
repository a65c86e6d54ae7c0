"""Several callbacks at once, each with its interval; their start, their end, and what is refused before training."""

import signal
from typing import Any

import gymnasium as gym
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.callbacks import (
    BaseCallback,
    Checkpoint,
    CSVLogger,
    EvaluateEvery,
    KeepBest,
    LivePlot,
    StopAtReturn,
    TensorBoardLogger,
)
from support.environments import Walk
from support.learners.learner_settings import run_settings
from support.parity import assert_same_run, run_of

CAR = "MountainCar-v0"
SHORT: dict[str, Any] = {"seed": 6, "episodes": 10, "max_episode_steps": 30}


class Diary(BaseCallback):
    """Writes down what happens to it, and stops the run after so many episodes."""

    def __init__(self, every: int | None = None, stop: int | None = None) -> None:
        super().__init__(every)
        self.stop = stop
        self.entries: list[Any] = []

    def on_start(self, config: qtab.Config, env: gym.Env | None) -> None:
        self.entries += ["start", config.env, env is not None]

    def __call__(self, progress: qtab.Progress) -> bool:
        self.entries.append(progress.episodes)
        return progress.episodes != self.stop

    def on_end(self) -> None:
        self.entries.append("end")


@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
def test_each_callback_has_its_interval(backend):
    plain: list[int] = []
    often, seldom, default = Diary(every=2), Diary(every=7), Diary()
    run = qtab.train(
        CAR,
        backend=backend,
        callback=[often, lambda progress: plain.append(progress.episodes), seldom, default],
        callback_every=5,
        **SHORT,
    )
    begun = ["start", CAR, backend == "gymnasium"]
    assert often.entries == [*begun, 2, 4, 6, 8, 10, "end"]
    assert seldom.entries == [*begun, 7, 10, "end"]
    assert default.entries == [*begun, 5, 10, "end"]
    assert plain == [5, 10]
    assert_same_run(run, qtab.train(CAR, **SHORT))


def test_any_callback_stops_the_run_and_all_see_where_it_ended():
    seen: list[int] = []
    stopper, seldom = Diary(every=3, stop=6), Diary(every=100)
    run = qtab.train(
        CAR, callback=(stopper, seldom, lambda progress: seen.append(progress.episodes)), callback_every=2, **SHORT
    )
    assert run.completed is False
    assert len(run.episode_returns) == 6
    assert seen == [2, 4, 6]
    assert stopper.entries[3:] == [3, 6, "end"]
    assert seldom.entries[3:] == [6, "end"]


def test_one_that_does_not_stop_the_run_does_not_overrule_one_that_does():
    assert (
        len(qtab.train(CAR, callback=[lambda p: False, lambda p: True], callback_every=4, **SHORT).episode_lengths) == 4
    )


@pytest.mark.parametrize("raised", [RuntimeError("enough"), KeyboardInterrupt()])
def test_an_exception_in_one_ends_them_all_and_carries_the_run(raised):
    first, last = Diary(), Diary()

    def fail(progress):
        raise raised

    with pytest.raises(type(raised)) as caught:
        qtab.train(CAR, callback=[first, fail, last], callback_every=4, **SHORT)
    assert caught.value is raised
    assert len(run_of(raised).episode_returns) == 4
    assert first.entries[3:] == [4, "end"]
    assert last.entries[3:] == ["end"]


@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
def test_ctrl_c_inside_a_callback_stops_the_run_and_keeps_it(backend, tmp_path):
    def interrupt(progress):
        if progress.episodes == 6:
            signal.raise_signal(signal.SIGINT)

    checkpoint = Checkpoint(tmp_path / "run.npz", every=4)
    with pytest.raises(KeyboardInterrupt) as caught:
        qtab.train(CAR, backend=backend, callback=[checkpoint, interrupt], callback_every=2, **SHORT)
    assert len(run_of(caught.value).episode_returns) == 6
    assert len(qtab.load(tmp_path / "run.npz").episode_returns) == 4


def test_one_that_cannot_start_leaves_the_others_ended_and_nothing_trained(tmp_path):
    diary, never = Diary(), Diary()
    with pytest.raises(OSError, match=r"^path must be a file") as caught:
        qtab.train(CAR, callback=[diary, Checkpoint(tmp_path / "missing" / "run.npz"), never], **SHORT)
    assert len(run_of(caught.value).episode_returns) == 0
    assert diary.entries[3:] == ["end"]
    assert never.entries == []


@pytest.mark.parametrize(
    ("callback", "message"),
    [
        (3, r"^callback must be callable, got 3$"),
        ("print", r"^callback must be callable, got 'print'$"),
        ({print}, r"^callback must be callable, got {"),
        ([print, 3], r"^callback\[1\] must be callable, got 3$"),
        ([print, [print]], r"^callback\[1\] must be callable, got \["),
        (StopAtReturn, r"^callback must be an instance, as in StopAtReturn\(\.\.\.\), got the class itself$"),
        ([LivePlot], r"^callback\[0\] must be an instance, as in LivePlot\(\.\.\.\), got the class itself$"),
    ],
)
def test_what_cannot_be_called_is_refused_by_name_before_anything_is_made(callback, message):
    with pytest.raises(TypeError, match=message):
        qtab.train("no such environment", callback=callback)


@pytest.mark.parametrize("callback", [[], (), None])
def test_no_callback_is_no_callback(callback):
    assert_same_run(qtab.train(CAR, callback=callback, **SHORT), qtab.train(CAR, **SHORT))


def all_of_them(folder: Any, env: gym.Env | None = None) -> list[Any]:
    evaluation = EvaluateEvery(episodes=2, every=3, env=env)
    return [
        evaluation,
        KeepBest(folder / "best.npz", episodes=1, every=2, env=env),
        Checkpoint(folder / "run.npz", every=2, numbered=True, keep=2),
        CSVLogger(folder / "log.csv", every=1, evaluation=evaluation),
        LivePlot(),
        StopAtReturn(1e300, window=1),
    ]


@given(data=st.data(), every=st.integers(1, 5))
@settings(max_examples=settings().max_examples // 5)
def test_a_run_with_all_callbacks_equals_the_one_without(data, every, tmp_path_factory):
    algorithm = data.draw(st.sampled_from(["q_learning", "double_q_learning", "sarsa_lambda", "dyna_q"]))
    chosen = data.draw(run_settings(algorithm))
    chosen["backend"] = data.draw(st.sampled_from(["rust", "gymnasium"]))
    callbacks = all_of_them(tmp_path_factory.mktemp("callbacks"))
    run = qtab.train(CAR, callback=callbacks, callback_every=every, **chosen)
    assert run.completed
    assert_same_run(run, qtab.train(CAR, **chosen))


def test_a_run_of_an_environment_of_ones_own_is_left_alone(tmp_path):
    chosen: dict[str, Any] = {"discretizer": "bins", "bins": 5, "episodes": 8, "seed": 1, "max_episode_steps": 9}
    alone = qtab.train(Walk(), **chosen)
    assert_same_run(qtab.train(Walk(), callback=all_of_them(tmp_path, Walk()), **chosen), alone)


def test_tensorboard_leaves_the_run_alone(tmp_path):
    run = qtab.train(CAR, callback=TensorBoardLogger(tmp_path / "curves"), callback_every=2, **SHORT)
    assert_same_run(run, qtab.train(CAR, **SHORT))


def test_callbacks_serve_one_run_after_the_other(tmp_path):
    callbacks = all_of_them(tmp_path)
    for _ in range(2):
        qtab.train(CAR, callback=callbacks, **SHORT)
    evaluation, best, checkpoint, *_ = callbacks
    assert evaluation.evaluated_at == [3, 6, 9, 10]
    assert best.evaluated_at == [2, 4, 6, 8, 10]
    assert [path.name for path in checkpoint.saved] == ["run-08.npz", "run-10.npz"]
    assert len((tmp_path / "log.csv").read_text().splitlines()) == 11


@pytest.mark.parametrize("every", [0, -1, 1.5, True, "1"])
@pytest.mark.parametrize("make", [lambda every: StopAtReturn(0, every=every), lambda every: LivePlot(every)])
def test_a_wrong_interval_is_refused(make, every):
    with pytest.raises((TypeError, ValueError), match=r"^every must be an integer of at least 1, got"):
        make(every)


def test_the_names_are_those_that_type_checkers_see():
    import ast
    from pathlib import Path

    tree = ast.parse(Path(str(qtab.callbacks.__file__)).read_text())
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    imported = {
        alias.name: statement.module
        for statement in block.body
        if isinstance(statement, ast.ImportFrom)
        for alias in statement.names
        if alias.asname == alias.name
    }
    assert imported == qtab.callbacks._MODULES
    for name in imported:
        assert getattr(qtab.callbacks, name).__name__ == name
        assert name in dir(qtab.callbacks)
    with pytest.raises(AttributeError, match=r"has no attribute 'Checkpont' \(did you mean 'Checkpoint'\?\)"):
        _ = qtab.callbacks.Checkpont  # type: ignore[attr-defined]

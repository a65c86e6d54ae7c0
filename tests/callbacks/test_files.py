"""Checkpoints and logs: what they write, when, and what they refuse."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.callbacks import Checkpoint, CSVLogger, EvaluateEvery, StopAtReturn, TensorBoardLogger
from support.files.tensorboard import curves, purged_from
from support.parity import assert_same_run

CAR = "MountainCar-v0"
SHORT: dict[str, Any] = {"seed": 6, "episodes": 10, "max_episode_steps": 30}
VARIED: dict[str, Any] = {"seed": 6, "episodes": 10, "env_kwargs": {"goal_velocity": -1.0}, "initial_q": 0.0}
"""Episodes with different returns."""


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def lines(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def stop_after(episodes: int) -> Any:
    return lambda progress: progress.episodes < episodes


def test_a_checkpoint_is_the_run_so_far(tmp_path):
    path = tmp_path / "run.npz"
    found: list[qtab.Run] = []
    run = qtab.train(
        CAR, callback=[Checkpoint(path, every=4), lambda p: found.append(qtab.load(path))], callback_every=4, **SHORT
    )
    assert [len(checkpoint.episode_returns) for checkpoint in found] == [4, 8, 10]
    for checkpoint, episodes in zip(found[:2], (4, 8), strict=True):
        assert checkpoint.completed is False
        assert_same_run(checkpoint, qtab.train(CAR, callback=stop_after(episodes), callback_every=4, **SHORT))
    assert_same_run(qtab.load(path), run)
    assert names(tmp_path) == ["run.npz"]


def test_a_checkpoint_is_written_where_another_callback_stops_the_run(tmp_path):
    checkpoint = Checkpoint(tmp_path / "run.npz", every=1000)
    run = qtab.train(CAR, callback=[checkpoint, stop_after(6)], callback_every=3, **SHORT)
    assert_same_run(qtab.load(tmp_path / "run.npz"), run)
    assert checkpoint.saved == [tmp_path / "run.npz"]


@pytest.mark.parametrize(("keep", "kept"), [(None, [3, 6, 9, 10]), (2, [9, 10]), (1, [10]), (9, [3, 6, 9, 10])])
def test_numbered_checkpoints_sort_by_their_numbers(tmp_path, keep, kept):
    checkpoint = Checkpoint(tmp_path / "run.npz", every=3, numbered=True, keep=keep)
    qtab.train(CAR, callback=checkpoint, **SHORT)
    assert names(tmp_path) == [f"run-{number:02}.npz" for number in kept]
    assert [path.name for path in checkpoint.saved] == names(tmp_path)
    assert len(qtab.load(checkpoint.saved[-1]).episode_returns) == 10


def test_the_last_checkpoint_survives_an_exception(tmp_path):
    def fail(progress):
        if progress.episodes == 6:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        qtab.train(CAR, callback=[fail, Checkpoint(tmp_path / "run.npz", every=2)], callback_every=2, **SHORT)
    assert len(qtab.load(tmp_path / "run.npz").episode_returns) == 4
    assert names(tmp_path) == ["run.npz"]


def test_a_log_has_a_line_for_each_interval(tmp_path):
    path = tmp_path / "log.csv"
    run = qtab.train(CAR, callback=CSVLogger(path, every=4), **SHORT)
    assert path.read_bytes().startswith(b"episodes,steps,mean_return,mean_length,epsilon,learning_rate,seconds\n4,")
    rows = lines(path)
    assert [int(row["episodes"]) for row in rows] == [4, 8, 10]
    for row, part in zip(rows, [slice(0, 4), slice(4, 8), slice(8, 10)], strict=True):
        assert float(row["mean_return"]) == run.episode_returns[part].mean()
        assert float(row["mean_length"]) == run.episode_lengths[part].mean()
        assert int(row["steps"]) == run.episode_lengths[: part.stop].sum()
    assert float(rows[0]["epsilon"]) == pytest.approx(0.8 * 0.7)
    assert [row["learning_rate"] for row in rows] == ["0.2"] * 3


def test_a_line_can_be_read_at_once(tmp_path):
    path = tmp_path / "log.csv"
    counts: list[int] = []
    qtab.train(CAR, callback=[CSVLogger(path), lambda p: counts.append(len(lines(path)))], callback_every=5, **SHORT)
    assert counts == [1, 2]


def test_a_log_has_the_metrics_that_were_asked_for_and_the_evaluations(tmp_path):
    path = tmp_path / "log.csv"
    evaluation = EvaluateEvery(episodes=2, every=5)
    log = CSVLogger(path, every=2, metrics=["epsilon", "mean_return"], evaluation=evaluation)
    qtab.train(CAR, exploration="softmax", temperature=1.0, callback=[evaluation, log], **SHORT)
    rows = lines(path)
    assert list(rows[0]) == ["episodes", "epsilon", "mean_return", "evaluation_return"]
    assert {row["epsilon"] for row in rows} == {""}
    assert [row["evaluation_return"] for row in rows] == ["", "", "-30.0", "", "-30.0"]


KILLED_AFTER = 7


def killed_then_resumed(folder: Path, make: Any, **config: Any) -> qtab.Run:
    """A run that dies after 7 episodes, three after its last checkpoint, and is resumed from there."""

    def kill(progress: qtab.Progress) -> None:
        if progress.episodes == KILLED_AFTER:
            raise KeyboardInterrupt

    path = folder / "state.npz"
    with pytest.raises(KeyboardInterrupt):
        qtab.train(CAR, callback=[make(), Checkpoint(path, every=4), kill], callback_every=1, **config)
    return qtab.resume(path, callback=make(), callback_every=1)


def test_a_log_is_continued_where_a_run_is_resumed(tmp_path):
    metrics = ["steps", "mean_return", "mean_length", "epsilon"]
    qtab.train(CAR, callback=CSVLogger(tmp_path / "whole.csv", every=3, metrics=metrics), **VARIED)
    for every in (2, 3):
        qtab.train(CAR, callback=CSVLogger(tmp_path / "whole.csv", every=every, metrics=metrics), **VARIED)
        killed_then_resumed(
            tmp_path, lambda every=every: CSVLogger(tmp_path / "log.csv", every, metrics=metrics), **VARIED
        )
        assert (tmp_path / "log.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()


def test_a_log_that_begins_with_the_resumed_part_does_not_count_the_earlier_one(tmp_path):
    part = qtab.train(CAR, callback=stop_after(4), callback_every=4, **VARIED)
    run = qtab.resume(part, callback=CSVLogger(tmp_path / "log.csv", every=3))
    rows = lines(tmp_path / "log.csv")
    assert [int(row["episodes"]) for row in rows] == [6, 9, 10]
    assert float(rows[0]["mean_return"]) == run.episode_returns[4:6].mean()
    assert int(rows[0]["steps"]) == run.episode_lengths[:6].sum()


def test_a_log_of_a_killed_process_may_end_within_a_line(tmp_path):
    path = tmp_path / "log.csv"
    part = qtab.train(CAR, callback=[CSVLogger(path, every=2), stop_after(4)], callback_every=4, **VARIED)
    path.write_bytes(path.read_bytes()[:-4])
    run = qtab.resume(part, callback=CSVLogger(path, every=2))
    rows = lines(path)
    assert [int(row["episodes"]) for row in rows] == [2, 6, 8, 10]
    assert float(rows[1]["mean_return"]) == run.episode_returns[2:6].mean()


def test_a_log_to_which_an_editor_added_blank_lines_is_continued(tmp_path):
    path = tmp_path / "log.csv"
    part = qtab.train(CAR, callback=[CSVLogger(path, every=2), stop_after(4)], callback_every=4, **VARIED)
    path.write_text(path.read_text() + "\n\n")
    qtab.resume(part, callback=CSVLogger(path, every=2))
    assert [int(row["episodes"]) for row in lines(path)] == [2, 4, 6, 8, 10]


def test_another_log_is_not_continued(tmp_path):
    path = tmp_path / "log.csv"
    part = qtab.train(CAR, callback=[CSVLogger(path), stop_after(4)], callback_every=4, **VARIED)
    before = path.read_bytes()
    with pytest.raises(
        ValueError, match=r"^path must be the log of the earlier part, with the columns episodes, steps, got"
    ):
        qtab.resume(part, callback=CSVLogger(path, metrics=["steps"]))
    assert path.read_bytes() == before


def test_tensorboard_continues_the_curves_of_a_resumed_run(tmp_path):
    folder = tmp_path / "curves"
    run = killed_then_resumed(tmp_path, lambda: TensorBoardLogger(folder, every=2, metrics=["mean_return"]), **VARIED)
    first, second = sorted(folder.iterdir())
    (tmp_path / "first").mkdir()
    first.rename(tmp_path / "first" / first.name)
    assert [step for step, _ in curves(tmp_path / "first")["mean_return"]] == [2, 4, 6]
    resumed = curves(folder)["mean_return"]
    assert [step for step, _ in resumed] == [6, 8, 10]
    assert resumed[0][1] == np.float32(run.episode_returns[4:6].mean())
    assert purged_from(second) == 5  # TensorBoard drops the first file's point at 6


def test_checkpoints_of_the_earlier_part_count(tmp_path):
    path = tmp_path / "run.npz"
    (tmp_path / "run-notes.npz").write_bytes(b"")
    qtab.train(CAR, seed=1, episodes=1, max_episode_steps=9).save(tmp_path / "run-01.npz")  # of another run
    make = lambda: Checkpoint(path, every=2, numbered=True, keep=2)  # noqa: E731
    qtab.train(CAR, callback=[make(), stop_after(6)], callback_every=2, **VARIED)
    kept = ["run-01.npz", "run-04.npz", "run-06.npz", "run-notes.npz"]
    assert names(tmp_path) == kept
    again = make()
    qtab.resume(tmp_path / "run-06.npz", callback=again)
    assert names(tmp_path) == ["run-01.npz", "run-08.npz", "run-10.npz", "run-notes.npz"]
    assert [saved.name for saved in again.saved] == ["run-08.npz", "run-10.npz"]


def test_a_log_of_an_interrupted_run_is_closed(tmp_path):
    log = CSVLogger(tmp_path / "log.csv")

    def fail(progress):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        qtab.train(CAR, callback=[log, fail], callback_every=5, **SHORT)
    assert log._log is None
    assert len(lines(tmp_path / "log.csv")) == 1


def test_tensorboard_gets_the_curves(tmp_path):
    folder = tmp_path / "a" / "b"
    evaluation = EvaluateEvery(episodes=1, every=5)
    board = TensorBoardLogger(folder, every=4, metrics=["mean_return", "steps", "epsilon"], evaluation=evaluation)
    run = qtab.train(CAR, callback=[evaluation, board], **SHORT)
    found = curves(folder)
    assert set(found) == {"mean_return", "steps", "epsilon", "evaluation_return", "settings/text_summary"}
    assert found["mean_return"] == [(4, -30.0), (8, -30.0), (10, -30.0)]
    assert found["steps"] == [(4, 120.0), (8, 240.0), (10, float(run.episode_lengths.sum()))]
    assert found["evaluation_return"] == [(8, -30.0), (10, -30.0)]
    assert [step for step, _ in found["epsilon"]] == [4, 8, 10]


def test_tensorboard_without_its_writer_names_the_command_that_installs_it(tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "tensorboardX", None)
    with pytest.raises(ModuleNotFoundError, match=r"(?i)pip install .*tensorboardX"):
        qtab.train(CAR, callback=TensorBoardLogger(tmp_path / "curves"), **SHORT)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda path: Checkpoint(path), IsADirectoryError, r"^path must be a file, got the folder"),
        (lambda path: CSVLogger(path), IsADirectoryError, r"^path must be a file, got the folder"),
        (lambda path: CSVLogger(path / "missing" / "log.csv"), OSError, r"^path must be a file that can be written"),
        (lambda path: TensorBoardLogger(path / "taken"), OSError, r"^folder must be a folder, got '.*taken': "),
        (lambda path: TensorBoardLogger(path / "taken" / "in"), OSError, r"^folder must be a folder, got '.*in': "),
    ],
)
def test_a_path_that_cannot_be_written_is_refused_before_training(tmp_path, make, error, message):
    (tmp_path / "taken").write_text("a file")
    callback = make(tmp_path)
    with pytest.raises(error, match=message) as caught:
        qtab.train(CAR, callback=callback, **SHORT)
    assert len(caught.value.run.episode_returns) == 0
    assert names(tmp_path) == ["taken"]


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: Checkpoint(3), TypeError, r"^path must be a path, got 3$"),  # type: ignore[arg-type]
        (lambda: Checkpoint(""), ValueError, r"^path must name a file, got ''$"),
        (lambda: Checkpoint("a.npz", keep=2), ValueError, r"^keep applies to numbered=True, .*, got 2$"),
        (lambda: Checkpoint("a.npz", numbered=True, keep=0), ValueError, r"^keep must be an integer of at least 1"),
        (lambda: Checkpoint("a.npz", numbered=1), TypeError, r"^numbered must be True or False, got 1$"),  # type: ignore[arg-type]
        (lambda: CSVLogger(None), TypeError, r"^path must be a path, got None$"),  # type: ignore[arg-type]
        (lambda: CSVLogger("a", metrics=["epsilom"]), ValueError, r"^metrics must .* \(did you mean 'epsilon'\?\)$"),
        (lambda: CSVLogger("a", metrics=["x", 3]), ValueError, r"^metrics must be among 'steps', .*, got 'x'$"),  # type: ignore[list-item]
        (lambda: CSVLogger("a", metrics="epsilon"), TypeError, r"^metrics must be a sequence of names, got 'epsilon'$"),
        (lambda: CSVLogger("a", metrics=3), TypeError, r"^metrics must be a sequence of names, got 3$"),  # type: ignore[arg-type]
        (lambda: CSVLogger("a", metrics=[]), ValueError, r"^metrics must hold at least one name, got none$"),
        (lambda: CSVLogger("a", evaluation=3), TypeError, r"^evaluation must be an EvaluateEvery or a KeepBest, got 3"),  # type: ignore[arg-type]
        (lambda: TensorBoardLogger(3), TypeError, r"^folder must be a path, got 3$"),  # type: ignore[arg-type]
        (lambda: TensorBoardLogger("a", metrics=["return"]), ValueError, r"^metrics must be among"),
        (lambda: StopAtReturn("a"), TypeError, r"^value must be a finite number, got 'a'$"),  # type: ignore[arg-type]
        (lambda: StopAtReturn(float("nan")), ValueError, r"^value must be finite, got nan$"),
        (lambda: StopAtReturn(0, window=0), ValueError, r"^window must be an integer of at least 1, got 0$"),
    ],
)
def test_wrong_arguments_are_refused_by_name(make, error, message):
    with pytest.raises(error, match=message):
        make()

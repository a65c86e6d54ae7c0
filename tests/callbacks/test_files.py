"""Checkpoints and logs: what they write, when, and what they refuse."""

import csv
import struct
from pathlib import Path
from typing import Any

import pytest

import qtab
from qtab.callbacks import Checkpoint, CSVLogger, EvaluateEvery, StopAtReturn, TensorBoardLogger
from support.parity import assert_same_run

CAR = "MountainCar-v0"
SHORT: dict[str, Any] = {"seed": 6, "episodes": 10, "max_episode_steps": 30}


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


def test_a_log_of_an_interrupted_run_is_closed(tmp_path):
    log = CSVLogger(tmp_path / "log.csv")

    def fail(progress):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        qtab.train(CAR, callback=[log, fail], callback_every=5, **SHORT)
    assert log._file is None
    assert len(lines(tmp_path / "log.csv")) == 1


def curves(folder: Path) -> dict[str, list[tuple[int, float]]]:
    """The points of the curves in TensorBoard's only file in a folder: a length, a checksum, an event, a checksum."""
    from tensorboardX.proto.event_pb2 import Event

    (path,) = folder.iterdir()
    content, at = path.read_bytes(), 0
    found: dict[str, list[tuple[int, float]]] = {}
    while at < len(content):
        (length,) = struct.unpack_from("<Q", content, at)
        event = Event.FromString(content[at + 12 : at + 12 + length])
        for value in event.summary.value:
            found.setdefault(value.tag, []).append((event.step, value.simple_value))
        at += 16 + length
    return found


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

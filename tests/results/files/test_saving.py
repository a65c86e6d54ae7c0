"""A file is written whole or not at all, through symbolic links, and never in place of what is no regular file."""

import os
import re
import socket
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import qtab
from qtab._utils.files import replacing
from support.files import kill_saves
from support.processes.command import refused

posix = pytest.mark.skipif(os.name != "posix", reason="needs the files of POSIX systems")


@pytest.fixture(scope="module")
def run() -> qtab.Run:
    return qtab.train("FrozenLake-v1", seed=0, episodes=2)


def make_socket(path: Path) -> None:
    # A socket's path must be short.
    before = Path.cwd()
    os.chdir(path.parent)
    try:
        with socket.socket(socket.AF_UNIX) as server:
            server.bind(path.name)
    finally:
        os.chdir(before)


def make_link_to_fifo(path: Path) -> None:
    os.mkfifo(path.with_name("pipe"))
    path.symlink_to("pipe")


SPECIAL: dict[str, tuple[Callable[[Path], object], str]] = {
    "FIFO": (os.mkfifo if hasattr(os, "mkfifo") else Path.touch, "the FIFO"),
    "link to a FIFO": (make_link_to_fifo, "the FIFO"),
    "socket": (make_socket, "the socket"),
    "device": (lambda path: path.symlink_to(os.devnull), "the device"),
    "folder": (Path.mkdir, "the folder"),
}


@posix
@pytest.mark.parametrize(("make", "named"), SPECIAL.values(), ids=SPECIAL)
def test_what_is_no_regular_file_is_refused_by_name_and_left_alone(run, tmp_path, make, named):
    path = tmp_path / "run.npz"
    make(path)
    before = sorted((entry.name, entry.lstat().st_mode, entry.lstat().st_ino) for entry in tmp_path.iterdir())
    with pytest.raises(OSError, match=f"^path must be a .*file, got {named} '{re.escape(str(path))}'$"):
        run.save(path)
    after = sorted((entry.name, entry.lstat().st_mode, entry.lstat().st_ino) for entry in tmp_path.iterdir())
    assert after == before
    assert stat.S_ISCHR(Path(os.devnull).stat().st_mode)


@posix
@pytest.mark.parametrize("option", ["--save", "--plot"])
def test_the_command_refuses_it_before_training(tmp_path, option):
    os.mkfifo(tmp_path / "pipe.png")
    error = refused("train", "--episodes", "3", option, "pipe.png", cwd=tmp_path)
    assert error == f"qtab train: error: {option} must be a regular file, got the FIFO 'pipe.png'"
    assert stat.S_ISFIFO((tmp_path / "pipe.png").stat().st_mode)


@posix
def test_a_link_stays_and_its_target_is_replaced(run, tmp_path):
    (tmp_path / "data").mkdir()
    target, link = tmp_path / "data" / "real.npz", tmp_path / "link.npz"
    (tmp_path / "second.npz").symlink_to("data/real.npz")
    link.symlink_to(tmp_path / "second.npz")
    for _ in range(2):  # first the target does not exist
        run.save(link)
        assert link.is_symlink()
        assert (tmp_path / "second.npz").is_symlink()
        assert qtab.load(target).tables.tobytes() == run.tables.tobytes()
        target.write_text("older")
    assert [entry.name for entry in (tmp_path / "data").iterdir()] == ["real.npz"]


@posix
def test_a_fifo_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="path must be a regular file, got the FIFO"):
        qtab.load(tmp_path / "pipe")


@posix
def test_links_in_a_circle_are_refused(run, tmp_path):
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    with pytest.raises(OSError, match="symbolic links"):
        run.save(tmp_path / "a")


@posix
def test_a_new_file_has_the_permissions_of_the_umask_and_an_old_one_keeps_its_own(run, tmp_path):
    path = tmp_path / "run.npz"
    before = os.umask(0o027)
    try:
        run.save(path)
    finally:
        os.umask(before)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    path.chmod(0o604)
    run.save(path)
    assert stat.S_IMODE(path.stat().st_mode) == 0o604


@posix
def test_the_content_reaches_the_disk_before_the_name_and_the_name_before_the_end(run, tmp_path, monkeypatch):
    path = tmp_path / "run.npz"
    run.save(path)
    old, synced = path.stat().st_ino, []

    def fsync(handle: int) -> None:
        synced.append((stat.S_ISDIR(os.fstat(handle).st_mode), path.stat().st_ino == old))

    monkeypatch.setattr(os, "fsync", fsync)
    run.save(path)
    assert synced == [(False, True), (True, False)]


@posix
def test_a_temporary_file_is_removed_once_its_process_is_gone_and_not_before(run, tmp_path):
    path = tmp_path / "run.npz"
    other = tmp_path / ".run-notes.npz"
    other.write_text("mine")
    with replacing(path) as temporary:
        assert re.fullmatch(r"\.run-[0-9a-f]{16}\.tmp\.npz", temporary.name)
        abandoned = temporary.with_name(f".run-{'0' * 16}.tmp.npz")
        abandoned.write_text("half")  # no process has it locked
        run.save(path)
        assert not abandoned.exists()
        temporary.write_text("whole")
    assert path.read_text() == "whole"
    assert other.read_text() == "mine"
    assert sorted(entry.name for entry in tmp_path.iterdir()) == [".run-notes.npz", "run.npz"]


def test_a_long_name_can_be_written(run, tmp_path):
    path = tmp_path / ("ü" * 120 + ".npz")
    run.save(path)
    assert qtab.load(path).completed


@posix
@pytest.mark.slow
def test_a_killed_save_leaves_the_old_file_or_the_new_one(tmp_path):
    done = subprocess.run(
        [sys.executable, kill_saves.__file__, str(tmp_path), "25"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("25 kills")


@posix
def test_the_points_of_an_experiment_are_written_in_the_same_way(tmp_path):
    os.mkfifo(tmp_path / "points.csv")
    with pytest.raises(OSError, match="path must be a regular file, got the FIFO"):
        qtab.book.run("example 6.6", runs=1).save(tmp_path / "points.csv")

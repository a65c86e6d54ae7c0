"""Stores on read-only media, and stores in which nothing is stored yet."""

import os
import shutil
import sqlite3
import stat
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest

import qtab
from support.sweeps import CAR, GRID, SMALL, assert_equal

NOBODY = 65534

posix = pytest.mark.skipif(os.name != "posix", reason="uses POSIX permissions")


@contextmanager
def read_only(folder: Path) -> Iterator[None]:
    """Takes the permission to write from a folder and its files, also from root."""
    paths = [folder, *folder.iterdir()]
    modes = [stat.S_IMODE(path.stat().st_mode) for path in paths]
    is_root = os.geteuid() == 0
    for path in paths:
        path.chmod(0o555 if path.is_dir() else 0o444)
    if is_root:
        os.seteuid(NOBODY)
    try:
        yield
    finally:
        if is_root:
            os.seteuid(0)
        for path, mode in zip(paths, modes, strict=True):
            path.chmod(mode)


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder that every user can reach, unlike pytest's."""
    made = Path(tempfile.mkdtemp())
    made.chmod(0o755)
    yield made
    shutil.rmtree(made)


@posix
def test_a_finished_store_on_a_read_only_medium_is_read_and_needs_no_training(folder: Path) -> None:
    path = folder / "study.db"
    table = qtab.sweep(CAR, GRID, store=path, **SMALL)
    with read_only(folder):
        assert qtab.load_sweep(path).columns["steps"].tolist() == table.columns["steps"].tolist()
        assert_equal(qtab.sweep(CAR, GRID, store=path, **SMALL), table)
        with pytest.raises(qtab.StoreError, match="has runs of 5 seeds, of which this sweep has only 4"):
            qtab.sweep(CAR, GRID, store=path, **{**SMALL, "seeds": 4})
    assert [file.name for file in folder.iterdir()] == ["study.db"]


@posix
def test_an_unfinished_store_on_a_read_only_medium_is_read_but_not_resumed(folder: Path, small_chunks: Any) -> None:
    def interrupt(progress: qtab.SweepProgress) -> None:
        raise KeyboardInterrupt

    path = folder / "study.db"
    with pytest.raises(KeyboardInterrupt):
        qtab.sweep(CAR, GRID, store=path, callback=interrupt, **SMALL)
    with read_only(folder):
        found = len(qtab.load_sweep(path))
        assert 0 < found < 30
        with pytest.raises(PermissionError, match=f"cannot be written, and has only {found} of 30 runs"):
            qtab.sweep(CAR, GRID, store=path, **SMALL)


KILLED = """
import os, sys, qtab
qtab.sweep("MountainCar-v0", {grid}, seeds=5, episodes=40, store=sys.argv[1],
           callback=lambda progress: progress.runs < 30 or os._exit(9))
"""


@posix
@pytest.mark.slow
def test_the_store_of_a_killed_process_is_read_with_its_log(folder: Path) -> None:
    path = folder / "study.db"
    ended = subprocess.run([sys.executable, "-c", KILLED.format(grid=GRID), str(path)], check=False)
    assert ended.returncode == 9
    assert path.with_name("study.db-wal").stat().st_size > 0
    with read_only(folder):
        assert len(qtab.load_sweep(path)) == 30
        assert len(qtab.sweep(CAR, GRID, store=path, **SMALL)) == 30
    assert {file.name for file in folder.iterdir()} >= {"study.db", "study.db-wal"}


@posix
@pytest.mark.parametrize("kind", ["no bytes", "no tables"])
def test_a_store_without_any_commit_is_said_to_be_empty(folder: Path, kind: str) -> None:
    path = folder / "study.db"
    path.touch()
    if kind == "no tables":
        with closing(sqlite3.connect(path)) as connection:
            connection.execute("PRAGMA journal_mode = WAL")
    with pytest.raises(qtab.StoreError, match="is empty: its sweep ended before storing anything; start it again"):
        qtab.load_sweep(path)
    with read_only(folder), pytest.raises(qtab.StoreError, match="is empty"):
        qtab.load_sweep(path)
    assert len(qtab.sweep(CAR, GRID, store=path, **SMALL)) == 30


@pytest.mark.parametrize(
    ("store", "error", "message"),
    [
        (":memory:", ValueError, "must be the path of a file, got ':memory:'; None keeps the results in memory"),
        ("", ValueError, "must be the path of a file, got ''"),
        ("file:x.db", ValueError, "must be the path of a file, got 'file:x.db'"),
        ("a\0b", ValueError, "must be the path of a file"),
        (3, TypeError, "store must be a path or None, got 3"),
        (b"x.db", TypeError, "store must be a path or None"),
        (tempfile.gettempdir(), IsADirectoryError, "store must be a file, got the folder"),
        (os.devnull, OSError, "store must be a regular file"),
    ],
)
def test_a_store_that_is_no_file_is_refused(store: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        qtab.sweep(CAR, GRID, store=store, **SMALL)
    with pytest.raises(error, match=message):
        qtab.load_sweep(store)

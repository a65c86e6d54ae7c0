"""Saving where an open file can be neither removed nor renamed, as on Windows; files of this process are looked up."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import qtab
from qtab._utils import files

pytestmark = pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="needs the list of a process's open files")


@pytest.fixture(autouse=True)
def open_files_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    def unless_open(call: Callable[..., Any]) -> Callable[..., Any]:
        def checked(path: Path, *arguments: Any, **keywords: Any) -> Any:
            opened = [str(entry.readlink()) for entry in Path("/proc/self/fd").iterdir() if entry.is_symlink()]
            if str(path.absolute()) in opened:
                raise PermissionError(13, "The process cannot access the file because it is being used", str(path))
            return call(path, *arguments, **keywords)

        return checked

    monkeypatch.setattr(files, "_LOCKS_BY_OPENING", True)
    monkeypatch.setattr(files, "fcntl", None)
    monkeypatch.setattr(Path, "unlink", unless_open(Path.unlink))
    monkeypatch.setattr(Path, "replace", unless_open(Path.replace))


def test_a_file_is_written_and_replaced(tmp_path: Path):
    run = qtab.train("MountainCar-v0", seed=0, episodes=5)
    for _ in range(2):
        run.save(tmp_path / "run.npz")
    assert qtab.load(tmp_path / "run.npz").episode_returns.tolist() == run.episode_returns.tolist()
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]


def test_a_failed_write_leaves_nothing(tmp_path: Path):
    def fail() -> None:
        with files.replacing(tmp_path / "run.npz") as temporary:
            temporary.write_bytes(b"half")
            raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        fail()
    assert list(tmp_path.iterdir()) == []


def test_files_of_killed_processes_are_removed_and_files_in_use_are_not(tmp_path: Path):
    abandoned = tmp_path / f".run-{'0' * 16}.tmp.npz"
    in_use = tmp_path / f".run-{'1' * 16}.tmp.npz"
    abandoned.write_bytes(b"")
    with in_use.open("wb"):
        qtab.train("MountainCar-v0", seed=0, episodes=5).save(tmp_path / "run.npz")
        assert sorted(path.name for path in tmp_path.iterdir()) == [in_use.name, "run.npz"]

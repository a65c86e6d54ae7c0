"""A run is saved whatever ends the command or its output: a closed pipe, SIGTERM, the end of the job."""

import json
import os
import signal
import stat
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import qtab
from qtab.cli import main
from qtab.results.run import Run
from support.parity import assert_same_run
from support.processes.command import QTAB, environment, qtab_here, refused
from support.processes.posix import posix_only

LAKE = ("FrozenLake-v1", "--seed", "0", "--episodes", "2000")


class ClosedPipe:
    """Standard output whose reader has left after some lines."""

    encoding = "utf-8"

    def __init__(self, lines: int, file: Any) -> None:
        self.lines, self.file = lines, file

    def write(self, text: str) -> int:
        self.lines -= text.count("\n")
        return len(text)

    def flush(self) -> None:
        is_discarded = stat.S_ISCHR(os.fstat(self.fileno()).st_mode)
        if self.lines < 0 and not is_discarded:
            raise BrokenPipeError

    def isatty(self) -> bool:
        return False

    def fileno(self) -> int:
        return int(self.file.fileno())


def with_closed_pipe(monkeypatch: pytest.MonkeyPatch, folder: Path, lines: int, *arguments: str) -> int:
    """Runs the command, whose output is read only to a line, and returns its exit code."""
    with (folder / "out").open("w") as file, monkeypatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(sys, "stdout", ClosedPipe(lines, file))
        return main([*arguments])


@pytest.mark.parametrize("lines", [0, 1, 5, 21])
@pytest.mark.parametrize("output", [(), ("--json",)])
def test_a_closed_pipe_does_not_lose_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lines: int, output: tuple[str, ...]
) -> None:
    code = with_closed_pipe(monkeypatch, tmp_path, lines, "train", *LAKE, "--save", "run.npz", *output)
    assert code == 0
    whole = qtab.train("FrozenLake-v1", seed=0, episodes=2000)
    assert_same_run(qtab.load(tmp_path / "run.npz"), whole)
    if not output:
        qtab.train("FrozenLake-v1", seed=0, episodes=2000, callback=lambda _: False, callback_every=500).save(
            tmp_path / "run.npz"
        )
        assert with_closed_pipe(monkeypatch, tmp_path, lines, "resume", "run.npz") == 0
        assert_same_run(qtab.load(tmp_path / "run.npz"), whole)


def test_without_a_file_to_write_a_closed_pipe_ends_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert with_closed_pipe(monkeypatch, tmp_path, 1, "train", *LAKE) == 1


@pytest.mark.parametrize("command", ["train", "verify"])
def test_help_that_is_not_read_ends_with_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    assert with_closed_pipe(monkeypatch, tmp_path, 0, command, "--help") == 1


def test_a_closed_pipe_does_not_end_a_sweep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = 'env = "FrozenLake-v1"\nseeds = 2\n[grid]\nlearning_rate = [0.1, 0.5]\n[config]\nepisodes = 20\n'
    (tmp_path / "s.toml").write_text(study)
    assert (
        with_closed_pipe(monkeypatch, tmp_path, 0, "sweep", "s.toml", "--confirm", "2", "--confirm-store", "c.db") == 0
    )
    assert len(qtab.load_sweep(tmp_path / "s.db")) == 4
    assert len(qtab.load_sweep(tmp_path / "c.db")) == 2


def test_the_run_is_saved_before_anything_is_printed_about_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    saved: list[bool] = []
    monkeypatch.setattr("qtab.cli.training_report._summary_text", lambda _: saved.append((tmp_path / "r").exists()))
    save = Run.save

    def save_and_tell(run: Run, path: Path) -> None:
        save(run, path)
        (tmp_path / "r").touch()

    monkeypatch.setattr(Run, "save", save_and_tell)
    assert qtab_here("train", *LAKE, "--save", "run.npz", cwd=tmp_path).returncode == 0
    assert saved == [True]


def test_where_it_cannot_be_saved_the_run_is_reported_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: Any) -> None:
        raise OSError(28, "No space left on device", "run.npz")

    monkeypatch.setattr(Run, "save", fail)
    done = qtab_here("train", *LAKE, "--save", "run.npz", cwd=tmp_path)
    assert done.returncode == 1
    assert "Mean return over the last 100 episodes" in done.stdout
    assert done.stderr == "qtab train: error: No space left on device: 'run.npz'\n"


def in_process(folder: Path, *arguments: str, **variables: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [*QTAB, *arguments],
        cwd=folder,
        env=environment(folder, **variables),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@posix_only
@pytest.mark.slow
@pytest.mark.parametrize("command", ["train", "resume"])
def test_sigterm_saves_what_was_learned_as_ctrl_c_does(tmp_path: Path, command: str) -> None:
    if command == "resume":
        qtab.train("MountainCar-v0", episodes=10**6, seed=0, callback=lambda _: False).save(tmp_path / "run.npz")
        arguments = ["resume", "run.npz"]
    else:
        arguments = ["train", "--episodes", "1000000", "--seed", "0", "--save", "run.npz"]
    process = in_process(tmp_path, *arguments)
    assert process.stdout is not None
    process.stdout.readline()
    assert process.stdout.readline().startswith("Episode 10000 ")
    process.send_signal(signal.SIGTERM)
    process.send_signal(signal.SIGTERM)
    out, err = process.communicate(timeout=600)
    assert (process.returncode, err) == (143, "")
    run = qtab.load(tmp_path / "run.npz")
    assert 10_000 <= len(run.episode_returns) < 1_000_000
    assert f"Stopped after {len(run.episode_returns):,} of 1,000,000 episodes" in out


@posix_only
def test_sigterm_is_turned_into_an_interruption_and_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def terminate(*_: Any, **__: Any) -> None:
        os.kill(os.getpid(), signal.SIGTERM)
        os.kill(os.getpid(), signal.SIGTERM)  # ignored, so that it does not interrupt the saving

    monkeypatch.setattr("qtab.cli.commands.train._header", terminate)
    assert qtab_here("train", *LAKE, cwd=tmp_path).returncode == 143
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    seen: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, _: seen.append(number))
    try:
        assert qtab_here("train", *LAKE, cwd=tmp_path).returncode == 0  # a program's own handler stays
        assert seen == [signal.SIGTERM, signal.SIGTERM]
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def test_checkpoints_are_saved_during_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    saved: list[int] = []
    save = Run.save

    def count(run: Run, path: Any) -> None:
        saved.append(len(run.episode_returns))
        save(run, path)

    monkeypatch.setattr(Run, "save", count)
    assert qtab_here("train", *LAKE, "--save", "run.npz", "--checkpoint", "800", cwd=tmp_path).returncode == 0
    assert saved == [800, 1600, 2000, 2000]
    saved.clear()
    more = ("--episodes", "3000", "--checkpoint", "800", "--json")
    printed = json.loads(qtab_here("resume", "run.npz", *more, cwd=tmp_path).stdout)
    assert (printed["episodes"], saved) == (3000, [2400, 3000, 3000])
    answer = refused("train", *LAKE, "--checkpoint", "800", cwd=tmp_path)
    assert answer == "qtab train: error: --checkpoint needs --save, the file that it writes"
    answer = refused("train", *LAKE, "--save", "a.npz", "--checkpoint", "0", cwd=tmp_path)
    assert answer == "qtab train: error: --checkpoint must be an integer of at least 1, got 0"


@pytest.mark.parametrize("episodes", [(), ("--episodes", "2000")])
def test_a_job_that_is_started_again_after_its_end_reports_the_run(tmp_path: Path, episodes: tuple[str, ...]) -> None:
    assert qtab_here("train", *LAKE, "--save", "run.npz", cwd=tmp_path).returncode == 0
    before = (tmp_path / "run.npz").read_bytes()
    done = qtab_here("resume", "run.npz", *episodes, "--checkpoint", "100", "--plot", "curve.png", cwd=tmp_path)
    assert done.returncode == 0, done
    header, *lines = done.stdout.splitlines()
    assert header == "FrozenLake-v1 in Rust, resumed after 2,000 of 2,000 episodes, seed 0"
    assert lines[0].startswith("Mean return over the last 100 episodes: ")
    assert lines[-1] == "Saved the plot to curve.png"
    assert (tmp_path / "run.npz").read_bytes() == before


def test_verify_takes_the_environment_that_a_package_registers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import gymnasium as gym

    (tmp_path / "ponds.py").write_text(
        "import gymnasium as gym\ngym.register('OwnPond-v0', 'gymnasium.envs.toy_text.frozen_lake:FrozenLakeEnv')\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    qtab.train("ponds:OwnPond-v0", seed=0, episodes=3, progress=False).save(tmp_path / "run.npz")
    del sys.modules["ponds"], gym.registry["OwnPond-v0"]
    assert "'ponds:OwnPond-v0' is not registered" in refused("verify", "run.npz", cwd=tmp_path)
    other = refused("verify", "run.npz", "--env", "Taxi-v4", cwd=tmp_path)
    assert other == "qtab verify: error: --env must be that of the run, 'ponds:OwnPond-v0', got 'Taxi-v4'"
    done = qtab_here("verify", "run.npz", "--env", "ponds:OwnPond-v0", cwd=tmp_path)
    assert done.returncode == 0, done
    del sys.modules["ponds"], gym.registry["OwnPond-v0"]


@posix_only
def test_sigterm_keeps_the_finished_runs_of_a_sweep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = 'env = "FrozenLake-v1"\nseeds = 4\n[grid]\nlearning_rate = [0.1, 0.5]\n[config]\nepisodes = 20\n'
    (tmp_path / "s.toml").write_text(study)
    monkeypatch.setattr("qtab.sweeps.worker.MAX_CHUNK_RUNS", 3)
    monkeypatch.setattr("qtab.sweeps.training.ProgressBar.move_to", lambda *_: os.kill(os.getpid(), signal.SIGTERM))
    done = qtab_here("sweep", "s.toml", cwd=tmp_path)
    kept = len(qtab.load_sweep(tmp_path / "s.db"))
    assert 0 < kept < 8
    assert (done.returncode, done.stdout.startswith(f"interrupted: kept {kept} run")) == (143, True)

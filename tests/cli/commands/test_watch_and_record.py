"""``qtab watch`` and ``qtab record``."""

from pathlib import Path

import pytest
from PIL import Image

import qtab
from qtab.cli.commands import watch
from qtab.rendering import play
from support.processes.command import qtab_here, refused, with_run


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return with_run(tmp_path, episodes=50, max_episode_steps=10)


def test_record_writes_a_video_of_the_episodes_of_evaluate(folder: Path) -> None:
    done = qtab_here("record", "run.npz", "--episodes", "2", "lake.gif", "--seed", "3", cwd=folder)
    assert done.returncode == 0, done
    assert done.stderr == ""
    evaluated = qtab.evaluate(qtab.load(folder / "run.npz"), 2, seed=3)
    results = zip(evaluated.returns, evaluated.lengths, strict=True)
    listed = ", ".join(f"return {one:.6g} in {steps} steps" for one, steps in results)
    assert done.stdout == f"FrozenLake-v1, 2 episodes, seed 3: {listed}\nSaved the video to lake.gif\n"
    with Image.open(folder / "lake.gif") as gif:
        assert gif.n_frames > 1


def test_watch_plays_in_a_window(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (watch, play):
        monkeypatch.setattr(module, "display_problem", lambda: None)
    done = qtab_here("watch", "run.npz", "--seed", "3", "--fps", "1000", cwd=folder, SDL_VIDEODRIVER="dummy")
    assert done.returncode == 0, done
    assert done.stdout == f"{qtab.play(qtab.load(folder / 'run.npz'), seed=3, window=False).summary}\n"


def test_wrong_calls_are_refused_in_one_line(folder: Path) -> None:
    (folder / "notes.npz").write_text("not a run")
    for arguments, message in {
        ("watch", "run.npz"): "qtab record run.npz agent.mp4 writes a video without one",
        ("watch", "none.npz"): "RUN must be a file that can be read, got 'none.npz'",
        ("record", "notes.npz", "lake.gif"): "is not a run file",
        ("record", "run.npz"): "PATH must be given",
        ("record", "run.npz", "lake.avi"): "PATH must end in one of .mp4, .gif, .html, got 'lake.avi'",
        ("record", "run.npz", "lake.gif", "--episodes", "0"): "--episodes must be an integer of at least 1, got 0",
        ("record", "run.npz", "lake.gif", "--seed", "-1"): "--seed must be an integer of at least 0, got -1",
        ("record", "run.npz", "lake.gif", "--max-episode-steps", "0"): "--max-episode-steps must be an integer of at",
        ("record", "run.npz", "lake.gif", "--fps", "x"): "--fps must be a number, got 'x'",
    }.items():
        assert message in refused(*arguments, cwd=folder), arguments


def test_an_environment_that_cannot_be_rendered_is_refused(tmp_path: Path) -> None:
    qtab.train("qtab/MaximizationBias-v0", episodes=5, seed=0).save(tmp_path / "run.npz")
    line = refused("record", "run.npz", "out.gif", cwd=tmp_path)
    assert "qtab/MaximizationBias-v0 cannot be rendered as 'rgb_array'; its render modes are: none" in line

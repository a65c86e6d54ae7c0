"""The learning curve of a run, and its progress bar."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.plots.parts.axes import check_format
from qtab.plots.run import save_plot
from support.processes.command import QTAB, environment


def curve(run: qtab.Run, block: int = 100) -> tuple[list[float], list[float]]:
    line: Any
    [line] = [line for line in qtab.plot(run, block=block).lines if str(line.get_label()).startswith("mean")]
    return list(line.get_xdata()), list(line.get_ydata())


def test_the_curve_is_the_block_means_at_the_ends_of_their_blocks() -> None:
    run = qtab.train("MountainCar-v0", episodes=450, seed=0)
    assert curve(run) == ([100, 200, 300, 400], run.mean_returns(100).tolist())
    assert curve(run, block=50) == (list(range(50, 451, 50)), run.mean_returns(50).tolist())


def test_every_episode_is_a_dot_and_the_title_lists_the_settings() -> None:
    run = qtab.train("MountainCar-v0", episodes=120, seed=7)
    ax = qtab.plot(run)
    dots: Any = ax.lines[0].get_ydata()
    assert dots.tolist() == run.episode_returns.tolist()
    assert ax.get_title("left") == "MountainCar-v0"
    assert ax.get_title("right") == "α = 0.2, γ = 0.9, ε = 0.8 → 0, seed 7"
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("episode", "return")


def test_an_axis_is_drawn_on_and_returned() -> None:
    from matplotlib.figure import Figure

    ax = Figure().subplots()
    assert qtab.plot(qtab.train("MountainCar-v0", episodes=100, seed=0), ax) is ax


def test_a_run_stopped_before_its_first_episode_can_be_drawn(tmp_path: Path) -> None:
    run = qtab.train("MountainCar-v0", episodes=3, seed=0)
    nothing = {"episode_returns": np.zeros(0), "episode_lengths": np.zeros(0, np.int64)}
    save_plot(type(run)(**{**vars(run), **nothing}), tmp_path / "a.png")


def test_dots_of_a_huge_run_are_thinned_and_its_means_are_not() -> None:
    run = qtab.train("MountainCar-v0", episodes=30_000, seed=0, max_episode_steps=2)
    cloud, means = qtab.plot(run).lines
    assert np.size(cloud.get_xdata()) == 20_000
    assert np.size(means.get_xdata()) == 30  # of 1,000 episodes each: 300 would be a thick band


def test_a_file_extension_that_matplotlib_does_not_support_is_refused() -> None:
    with pytest.raises(ValueError, match=r"plot must end in one of .*\.jpg.*, got 'a.docx'"):
        check_format("plot", Path("a.docx"))
    check_format("plot", Path("A.PNG"))


def test_a_plot_that_fails_leaves_no_partial_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError("the disk is full")

    run = qtab.train("MountainCar-v0", episodes=100, seed=0)
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", fail)
    with pytest.raises(OSError, match="the disk is full"):
        save_plot(run, tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_progress_shows_a_bar_when_asked_and_changes_no_number(capsys: pytest.CaptureFixture[str]) -> None:
    shown = qtab.train("MountainCar-v0", episodes=500, seed=0, progress=True)
    assert "/500 [" in capsys.readouterr().err
    hidden = qtab.train("MountainCar-v0", episodes=500, seed=0, progress=False)
    unasked = qtab.train("MountainCar-v0", episodes=500, seed=0)
    assert capsys.readouterr() == ("", "")
    assert shown.q_table.tobytes() == hidden.q_table.tobytes() == unasked.q_table.tobytes()
    assert shown.episode_returns.tobytes() == hidden.episode_returns.tobytes()


def test_progress_and_a_callback_go_together() -> None:
    seen: list[int] = []
    qtab.train(
        *("MountainCar-v0",),
        episodes=250,
        seed=0,
        progress=True,
        callback=lambda now: seen.append(now.episodes),
        callback_every=70,
    )
    assert seen == [70, 140, 210, 250]


def test_progress_must_be_true_false_or_none() -> None:
    with pytest.raises(TypeError, match="progress must be True, False or None, got 'yes'"):
        qtab.train("MountainCar-v0", episodes=5, progress="yes")  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="it has no pseudo-terminals")
def test_progress_bar_and_printed_lines_do_not_overlap_on_a_terminal(tmp_path: Path) -> None:
    import fcntl
    import os
    import pty
    import struct
    import subprocess
    import termios

    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
    # Each step sleeps, so that the run takes longer than the second after which the bar appears.
    arguments = ["train", "toys:Walk-v0", "--scale", "1", "--episodes", "200", "--env-kwargs", "pause", "0.002"]
    variables = environment(tmp_path, TERM="xterm")
    process = subprocess.Popen([*QTAB, *arguments], cwd=tmp_path, env=variables, stdout=theirs, stderr=theirs)
    os.close(theirs)
    screen = b""
    try:
        while chunk := os.read(ours, 65536):
            screen += chunk
    except OSError:  # on Linux, the other side is closed
        pass
    os.close(ours)
    assert process.wait() == 0
    text = screen.decode()
    assert "/200 [" in text
    lines = [line.rpartition("\r")[2] for line in text.split("\r\n")]
    assert [line for line in lines if line.startswith("Episode")][-1].startswith("Episode 200 Average Reward: ")
    assert lines[-2].startswith("Mean return over the last 100 episodes")


def test_an_invalid_optimum_is_refused_by_name() -> None:
    run = qtab.train("MountainCar-v0", seed=0, episodes=10)
    with pytest.raises(TypeError, match=r"^optimum must be a number or a result of qtab.optimum, got .best."):
        qtab.plot(run, optimum="best")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("settings", "note"),
    [
        ({"exploration": "softmax", "temperature": 0.5}, "α = 0.2, γ = 0.9, τ = 0.5, seed 0"),
        ({"epsilon_schedule": "constant", "epsilon": 0.1}, "α = 0.2, γ = 0.9, ε = 0.1, seed 0"),
        ({"epsilon_schedule": "exponential"}, "α = 0.2, γ = 0.9, ε = 0.8 → 0.799, seed 0"),
    ],
)
def test_every_kind_of_exploration_can_be_plotted(settings: dict[str, object], note: str) -> None:
    run = qtab.train("MountainCar-v0", episodes=2, seed=0, **settings)  # type: ignore[arg-type]
    assert qtab.plot(run).get_title("right") == note

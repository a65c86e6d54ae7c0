"""``qtab book`` as a user runs it."""

import subprocess
import sys

import pytest

import qtab
from support.processes.command import environment, qtab_here, refused
from support.processes.posix import posix_only


def test_without_a_name_the_experiments_are_listed(tmp_path):
    done = qtab_here("book", cwd=tmp_path)
    assert done.returncode == 0
    names = [row.split()[0] for row in done.stdout.splitlines() if row.startswith("  ")]
    assert names == list(qtab.book.EXPERIMENTS)
    assert "  example-6.5   Sarsa on the windy grid world\n" in done.stdout


def test_an_experiment_prints_its_settings_and_its_table(tmp_path):
    done = qtab_here("book", "8.2", "--runs", "3", "--plot", "maze.png", "--save", "maze.csv", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("Figure 8.2: Dyna-Q")
    assert "α = 0.1, ε = 0.1, γ = 0.95" in done.stdout
    assert "3 runs of each setting (FEWER than the 30 of the full figure)" in " ".join(done.stdout.split())
    assert "truncated at 5,000 steps" in " ".join(done.stdout.split())
    assert "std. error" in done.stdout
    assert (tmp_path / "maze.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "maze.csv").read_text().startswith("line,x,mean,standard_error,runs,")
    _, rows = str(qtab.book.run("8.2", runs=3)).split("\n\n")
    assert rows in done.stdout


def test_a_complete_figure_prints_its_number_of_runs(tmp_path):
    done = qtab_here("book", "8.2", cwd=tmp_path)
    assert "30 runs of each setting, seeds from 0" in done.stdout
    assert "FEWER" not in done.stdout


def test_a_number_that_two_experiments_share_is_that_of_the_figure(tmp_path):
    done = qtab_here("book", "11.2", cwd=tmp_path)
    first, second = done.stdout.splitlines()[:2]
    assert first == "11.2 is figure-11.2; qtab book example-11.2 runs the example"
    assert second.startswith("Figure 11.2: ")
    assert qtab_here("book", "figure-11.2", cwd=tmp_path).stdout.startswith("Figure 11.2: ")


CHAPTER_6 = "example-6.2, figure-6.2, example-6.5, example-6.6, figure-6.3, figure-6.5 for chapter 6"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["99"], "qtab book: error: NAME must be one of figure-2.1, figure-2.2"),
        (["6.9"], f"qtab book: error: NAME must be one of {CHAPTER_6}, got '6.9'"),
        (["chapter_7"], "qtab book: error: NAME must be figure-7.2 for chapter 7, got 'chapter_7'"),
        (["figure-6.9"], f"qtab book: error: NAME must be one of {CHAPTER_6}, got 'figure-6.9'"),
        (["8.2", "--runs", "0"], "qtab book: error: --runs must be an integer of at least 1, got 0"),
        (["8.2", "--runs", "many"], "many"),
        (["8.2", "--seed", "-1"], "seed must be an integer of at least 0, got -1"),
        (["8.2", "--threads", "0"], "threads must be an integer from 1 to 1024, got 0"),
        (["8.2", "--plot", "maze.tex.gz"], "plot must end in one of"),
        (["8.2", "--plot", "nowhere/maze.png"], "plot must be a file that can be written"),
        (["8.2", "--save", "nowhere/maze.csv"], "save must be a file that can be written"),
    ],
)
def test_bad_usage_is_refused_before_anything_runs(arguments, message, tmp_path):
    assert message in refused("book", *arguments, cwd=tmp_path)


INTERRUPTED = """
import os, signal, sys, threading, time
from qtab.book import runner
from qtab.cli import main

signal.signal(signal.SIGINT, signal.default_int_handler)  # what a shell starts in the background would ignore it

def at_work():
    frame = sys._current_frames()[threading.main_thread().ident]
    while frame is not None and frame.f_code is not runner.train_runs.__code__:
        frame = frame.f_back
    return frame is not None

def interrupt():
    while not at_work():
        time.sleep(0.01)
    began = time.process_time()
    while time.process_time() < began + 0.2:
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=interrupt, daemon=True).start()
sys.exit(main(["book", "6.3", "--plot", "cliff.png"]))
"""


@pytest.mark.slow
@posix_only
def test_ctrl_c_stops_an_experiment_and_leaves_no_file(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED], cwd=tmp_path, env=environment(tmp_path), capture_output=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, b"", b"")
    assert not (tmp_path / "cliff.png").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--plot", "maze.png"], "NAME must be given"),
        (["--out", "figures"], "NAME must be given"),
        (["all"], "--out must name a folder for qtab book all"),
        (
            ["all", "--out", "figures", "--plot", "maze.png"],
            "--out must name a folder for qtab book all, without --plot",
        ),
        (["8.2", "--out", "figures"], "--out must be left out, except with qtab book all"),
        (["all", "--out", "figures", "--runs", "0"], "--runs must be an integer of at least 1, got 0"),
    ],
)
def test_a_file_or_a_folder_needs_its_experiments(arguments, message, tmp_path):
    assert message in refused("book", *arguments, cwd=tmp_path)
    assert not (tmp_path / "figures").exists()

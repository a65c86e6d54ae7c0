"""A check gives the same report in notebooks, in pytest's worker processes, and in several threads at once."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from qtab.exercises import check, find

HOMEWORK = """
import numpy as np


def epsilon_greedy(values, epsilon, rng):
    if rng.random() < 1 - epsilon:
        return int(np.argmax(values))
    return int(rng.integers(len(values)))


def sample_average(estimates, counts, action, reward):
    estimates[action] += 1 / (counts[action] + 1) * (reward - estimates[action])
"""
TESTS = """
import pytest

import homework
import qtab


@pytest.mark.parametrize("name", ["epsilon_greedy", "sample_average"])
def test_exercise(name):
    qtab.exercises.check(name, getattr(homework, name)).assert_passed()
"""


def greedy(values, epsilon, rng):
    return int(np.argmax(values))


def epsilon_greedy(values, epsilon, rng):
    return greedy(values, epsilon, rng) if rng.random() < 1 - epsilon else int(rng.integers(len(values)))


def forever(values, epsilon, rng):
    while True:
        pass


@pytest.mark.slow
def test_pytest_in_two_processes_shows_the_report_of_the_wrong_function(tmp_path: Path) -> None:
    (tmp_path / "homework.py").write_text(HOMEWORK, encoding="utf-8")
    (tmp_path / "test_homework.py").write_text(TESTS, encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-n", "2", "-p", "no:cacheprovider", "-q", "test_homework.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 1, done.stderr
    assert "1 failed, 1 passed" in done.stdout
    assert "exercise 2, sample_average: 0 of 2 checks passed" in done.stdout
    assert "counts never changes" in done.stdout


def test_a_notebook_shows_the_report_as_a_table_and_names_the_line_of_the_cell(tmp_path: Path) -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    sources = [
        "import qtab",
        "def epsilon_greedy(values, epsilon, rng):\n    return best",
        "qtab.exercises.check(1, epsilon_greedy)",
        "qtab.exercises.check(1, lambda values, epsilon, rng: [0 for _ in iter(int, 1)], seconds=0.05)",
    ]
    cells = [nbformat.v4.new_code_cell(source) for source in sources]
    notebook = nbformat.v4.new_notebook(cells=cells)
    nbclient.NotebookClient(
        notebook, timeout=600, startup_timeout=600, resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    raised, stopped = (cell.outputs[0].data["text/html"] for cell in notebook.cells[2:])
    assert "0 of 4 checks passed" in raised
    assert "NameError" in raised
    assert "in line 2: return best" in raised
    assert stopped.count("it was stopped after 0.05 seconds") == 1
    assert stopped.count("the same as in the check above") == 3


def test_checks_in_threads_do_not_mix() -> None:
    sarsa = find("sarsa").model
    tasks: list[tuple[str, Any, float]] = [
        ("epsilon_greedy", epsilon_greedy, 10.0),
        ("epsilon_greedy", forever, 0.1),
        ("sarsa", sarsa, 10.0),
        ("epsilon_greedy", greedy, 10.0),
        ("sarsa", sarsa, 10.0),
    ]
    with ThreadPoolExecutor(len(tasks)) as pool:
        reports = list(pool.map(lambda task: check(task[0], task[1], seconds=task[2]), tasks))
    alone = [check(name, function, seconds=seconds) for name, function, seconds in tasks]
    assert [str(report) for report in reports] == [str(report) for report in alone]
    assert [report.passed for report in reports] == [True, False, True, False, True]

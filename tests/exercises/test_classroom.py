"""A class: tasks are handed out, and submissions are graded in separate processes."""

import json
import runpy
from pathlib import Path
from typing import Any

import pytest

from qtab.exercises import find, grade, hand_out
from qtab.exercises.classroom.student_code import definitions
from qtab.exercises.classroom.submissions import submissions

GREEDY = """\
import numpy as np

def epsilon_greedy(values, epsilon, rng):
    if rng.random() < 1 - epsilon:
        return int(np.argmax(values))
    return int(rng.integers(len(values)))
"""
AVERAGE = """\
def sample_average(estimates, counts, action, reward):
    counts[action] += STEP
    estimates[action] += 1 / counts[action] * (reward - estimates[action])
"""


def notebook(*cells: str) -> str:
    found: list[dict[str, Any]] = [{"cell_type": "markdown", "source": "# Homework"}]
    found += [{"cell_type": "code", "source": cell.splitlines(keepends=True)} for cell in cells]
    return json.dumps({"cells": found, "metadata": {}, "nbformat": 4, "nbformat_minor": 5})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("submissions")
    trials = "%matplotlib inline\n!pip install x\nepsilon_greedy?\nSTEP = 1\ncurve = train(1000)\nwhile True: pass"
    (folder / "ada.ipynb").write_text(notebook("%%time\n1 +", GREEDY, trials, AVERAGE, "def broken(:"))
    (folder / "bob.py").write_text("def epsilon_greedy(values, epsilon, rng):\n    while True: pass\n")
    (folder / "cleo.py").write_text(f"import os\ndef epsilon_greedy(*all):\n    os._exit(0)\nSTEP = 2\n{AVERAGE}")
    (folder / "dan" / "week").mkdir(parents=True)
    (folder / "dan" / "helpers.py").write_text("STEP = 1\n")
    (folder / "dan" / "week" / "homework.py").write_text(f"from helpers import STEP\nprint({{}}['a'])\n{AVERAGE}")
    (folder / "eve" / ".ipynb_checkpoints").mkdir(parents=True)
    (folder / "eve" / ".ipynb_checkpoints" / "old.py").write_text(GREEDY)
    (folder / "notes.txt").write_text("not a submission")
    return folder


def test_a_class_is_graded(folder: Path, tmp_path: Path) -> None:
    marks = grade(folder, ["epsilon_greedy", 2], seconds=0.5, processes=2)
    assert str(marks).splitlines() == [
        "student  epsilon_greedy  sample_average  sum",
        "ada      4 of 4          2 of 2          6 of 6",
        "bob      0 of 4          0 of 2          0 of 6",
        "cleo     0 of 4          0 of 2          0 of 6",
        "dan      0 of 4          2 of 2          2 of 6",
        "eve      0 of 4          0 of 2          0 of 6",
    ]
    reports = {student: [mark.report for mark in marks.of(student)] for student in marks.students}
    assert reports["ada"][0].startswith("exercise 1, epsilon_greedy: all 4 checks passed")
    stopped = "it was stopped after 0.5 seconds (is there a loop that never ends?), in line 2: while True: pass"
    assert stopped in " ".join(reports["bob"][0].split())
    assert "sample_average: there is no function of this name in bob.py" in reports["bob"][1]
    assert "the code ended its process" in reports["cleo"][0]
    assert "exercise 2, sample_average: 0 of 2 checks passed" in reports["cleo"][1]
    assert "there is no .py file and no notebook" in reports["eve"][0]
    marks.save(tmp_path / "marks.csv")
    rows = (tmp_path / "marks.csv").read_text(encoding="utf-8").splitlines()
    assert rows[:2] == ["student,epsilon_greedy (of 4),sample_average (of 2),sum (of 6)", "ada,4,2,6"]
    marks.save_reports(tmp_path / "reports")
    assert (tmp_path / "reports" / "dan.txt").read_text(encoding="utf-8") == "\n\n".join(reports["dan"]) + "\n"
    assert "<td" in marks._repr_html_()
    with pytest.raises(ValueError, match=r"there is no submission of 'adda' \(did you mean 'ada'\?\)"):
        marks.of("adda")


def test_only_definitions_are_run(tmp_path: Path) -> None:
    file = tmp_path / "homework.py"
    file.write_text(
        "from __future__ import annotations\nA = 2\nB = A + 1\nC = missing\nD = missing\n"
        "def f(x: Unknown):\n    return B + D\nraise SystemExit\n"
    )
    found, notes = definitions([file], seconds=5.0)
    assert found["f"].__annotations__ == {"x": "Unknown"}
    assert (found["B"], "C" in found) == (3, False)
    assert notes == ["homework.py, line 5 raised NameError: name 'missing' is not defined"]
    (tmp_path / "bad.ipynb").write_text("[]")
    assert definitions([tmp_path / "bad.ipynb"], 5.0)[1][0].startswith("bad.ipynb cannot be read: ")


def test_a_folder_without_submissions_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"must hold a \.py file, a notebook or a folder of each student"):
        submissions(tmp_path)
    with pytest.raises(ValueError, match="must be a folder of submissions"):
        grade(tmp_path / "none", ["sarsa"])


@pytest.mark.parametrize("exercises", [[], ["sarsa", 7], "sarsa"])
def test_exercises_are_named_once(tmp_path: Path, exercises: Any) -> None:
    with pytest.raises((ValueError, TypeError), match="exercises must "):
        hand_out(exercises, tmp_path / "homework.py")


def test_the_notebook_has_the_tasks(tmp_path: Path) -> None:
    hand_out(["epsilon_greedy", 7], tmp_path / "homework.ipynb")
    nbformat = pytest.importorskip("nbformat")
    book = nbformat.read(tmp_path / "homework.ipynb", as_version=4)
    nbformat.validate(book)
    assert [cell.cell_type for cell in book.cells] == 2 * ["markdown", "code", "code"]
    assert book.cells[4].source == find("sarsa").starter.rstrip("\n")
    assert book.cells[5].source == 'import qtab\n\nqtab.exercises.check("sarsa", sarsa)'


def test_the_file_prints_the_reports(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    hand_out(["epsilon_greedy", "sample_average"], tmp_path / "homework.py")
    runpy.run_path(str(tmp_path / "homework.py"), run_name="__main__")
    assert capsys.readouterr().out.count("FAILED") == 6
    with pytest.raises(ValueError, match=r"path must end in \.ipynb or \.py, got"):
        hand_out(["sarsa"], tmp_path / "homework.txt")

"""``qtab.exercises.grade``: the marks of a folder of submissions, each checked in a separate process."""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from qtab._utils import checks
from qtab._utils.progress import ProgressBar, check_progress
from qtab.exercises.classroom.handing_out import found, key_of
from qtab.exercises.classroom.marks import Mark, Marks, without_checks
from qtab.exercises.classroom.submissions import Submission, submissions
from qtab.exercises.exercise import Exercise

_START_SECONDS = 60.0
"""What a process may take besides its checks."""
_LOST = "the code ended its process, or did not return and could not be stopped"


def grade(
    folder: str | PathLike[str],
    exercises: Sequence[str | int | Exercise],
    *,
    exact: bool = True,
    seconds: float = 10.0,
    processes: int | None = None,
    progress: bool | None = None,
) -> Marks:
    """Checks the functions that students handed in.

    Each student is graded in a separate process: code that hangs, or ends the process, affects no one else. This is not
    a sandbox: grade code that you do not trust on a machine that you can afford to lose.

    Of each file and notebook, only imports, functions, classes, and the assignments of names that functions use are
    run. Plots, long training runs and cells that fail are left out.

    Args:
        folder: The submissions: a folder for each student, or a file ``.py`` or ``.ipynb``, named for the student.
        exercises: The names or numbers of the exercises. An exercise of your own is ``"module:NAME"``.
        exact: As for :func:`qtab.exercises.check`.
        seconds: The time limit of each call, as for :func:`qtab.exercises.check`.
        processes: The number of students to grade at the same time; None for one on each core.
        progress: Whether to show a progress bar over the students. None shows one on a terminal or in a notebook, if
            grading takes more than a second and tqdm is installed.

    Returns:
        The marks, which show themselves as a table.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: if there is no such exercise, or no submission.
        OSError: if the folder cannot be read.
    """
    check_progress(progress)
    known = found(exercises)
    exact = checks.boolean("exact", exact)
    if checks.finite("seconds", seconds) <= 0.0:
        raise ValueError(f"seconds must be positive, got {seconds!r}")
    count = (os.cpu_count() or 1) if processes is None else checks.integer("processes", processes, least=1)
    handed_in = submissions(checks.path("folder", folder))
    task = {"exercises": [key_of(one) for one in exercises], "exact": exact, "seconds": float(seconds)}
    marks: list[Mark] = []
    with ThreadPoolExecutor(count) as pool, ProgressBar(len(handed_in), "student", progress, "grade") as bar:
        for number, row in enumerate(pool.map(partial(_grade, known, task), handed_in)):
            marks += row
            bar.move_to(number + 1)
    return Marks(tuple(exercise.name for exercise in known), tuple(marks))


def _grade(exercises: Sequence[Exercise], task: dict[str, Any], submission: Submission) -> list[Mark]:
    """Returns the marks of a student, one for each exercise."""
    files = [str(file.resolve()) for file in submission.files]
    folders = [str(Path.cwd()) if folder == "" else folder for folder in sys.path]
    answers: list[dict[str, Any]] = []
    while len(answers) < len(exercises):
        rest, keys = exercises[len(answers) :], task["exercises"][len(answers) :]
        command = json.dumps({**task, "exercises": keys, "files": files, "path": folders})
        limit = _START_SECONDS + 2 * task["seconds"] * sum(len(exercise.checks) + 1 for exercise in rest)
        done = _output([sys.executable, "-m", "qtab.exercises.classroom.marking", command], limit)
        finished = [json.loads(line) for line in done.splitlines()]
        answers += finished
        if len(finished) < len(rest):  # the next process begins after the exercise that ended this one
            answers.append({"passed": 0, "report": without_checks(rest[len(finished)], _LOST)})
    return [
        Mark(submission.student, exercise.name, answer["passed"], len(exercise.checks), answer["report"])
        for exercise, answer in zip(exercises, answers, strict=True)
    ]


def _output(command: Sequence[str], seconds: float) -> str:
    """Returns what a process wrote until its end, or until it was killed."""
    # An unhandled error of the process would be one of the grader: its traceback belongs on the screen.
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, encoding="utf-8") as process:  # noqa: S603 - our own program
        try:
            return process.communicate(timeout=seconds)[0]
        except subprocess.TimeoutExpired:
            process.kill()
            return process.communicate()[0]

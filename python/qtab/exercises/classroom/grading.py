"""``qtab.exercises.grade``: the marks of a folder of submissions, each checked in a separate process."""

import json
import os
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
from qtab.exercises.classroom.processes import Processes
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
    run, also those in ``if`` and ``try`` statements. Plots, long training runs and cells that fail are left out.

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
    running = Processes()
    with ThreadPoolExecutor(count) as pool, ProgressBar(len(handed_in), "student", progress, "grade") as bar:
        try:
            for number, row in enumerate(pool.map(partial(_grade, known, task, running), handed_in)):
                marks += row
                bar.move_to(number + 1)
        finally:  # after Ctrl-C, too, which the processes do not receive
            running.stop()
    return Marks(tuple(exercise.name for exercise in known), tuple(marks))


def _grade(
    exercises: Sequence[Exercise], task: dict[str, Any], running: Processes, submission: Submission
) -> list[Mark]:
    """Returns the marks of a student, one for each exercise."""
    files = [str(file.resolve()) for file in submission.files]
    folders = [str(Path.cwd()) if folder == "" else folder for folder in sys.path]
    keys = {exercise.name: key for exercise, key in zip(exercises, task["exercises"], strict=True)}
    answers: dict[str, dict[str, Any]] = {}
    while rest := [exercise for exercise in exercises if exercise.name not in answers]:
        names = [keys[exercise.name] for exercise in rest]
        command = json.dumps({**task, "exercises": names, "files": files, "path": folders})
        limit = _START_SECONDS + 2 * task["seconds"] * sum(len(exercise.checks) + 1 for exercise in rest)
        done = running.output([sys.executable, "-m", "qtab.exercises.classroom.student_process", command], limit)
        answers = {**_answers(done), **answers}
        lost = next((exercise for exercise in rest if exercise.name not in answers), None)
        if lost is not None:  # the next process begins after the exercise that ended this one
            answers[lost.name] = {"passed": 0, "report": without_checks(lost, _LOST)}
    return [
        Mark(submission.student, one.name, answers[one.name]["passed"], len(one.checks), answers[one.name]["report"])
        for one in exercises
    ]


def _answers(text: str) -> dict[str, dict[str, Any]]:
    """Returns the answers of a process by exercise.

    A function that calls ``os.fork`` continues in two processes, which both write answers: the first ones count. A line
    that the end of the process cut off is left out.
    """
    found: dict[str, dict[str, Any]] = {}
    for line in text.splitlines():
        try:
            answer = json.loads(line)
            found.setdefault(answer["exercise"], {"passed": int(answer["passed"]), "report": str(answer["report"])})
        except (ValueError, TypeError, KeyError):
            continue
    return found

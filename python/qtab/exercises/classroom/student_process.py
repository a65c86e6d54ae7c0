"""The process that checks the functions of one student: ``python -m qtab.exercises.classroom.student_process TASK``.

TASK is a JSON object. For each exercise, the process writes a line of JSON to standard output; what the student's code
prints is discarded.
"""

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from qtab._utils.shown import did_you_mean
from qtab.exercises.classroom.marks import without_checks
from qtab.exercises.classroom.student_code import definitions
from qtab.exercises.collection import find
from qtab.exercises.exercise import Exercise
from qtab.exercises.grader import check


def main(task: Mapping[str, Any]) -> None:
    """Checks the exercises of a task, and writes a line for each.

    Args:
        task: ``exercises``, ``files``, ``exact`` and ``seconds``; and ``path``, the folders in which the modules of
            exercises are looked up.
    """
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as out:
        _discard_output()
        sys.path[:0] = task["path"]
        exercises = [find(name) for name in task["exercises"]]
        files = [Path(file) for file in task["files"]]
        sys.path += list(dict.fromkeys(str(file.parent) for file in files))  # a student's own modules
        namespace, notes = definitions(files, task["seconds"], [exercise.name for exercise in exercises])
        for exercise in exercises:
            passed, text = _mark(exercise, namespace, files, task)
            if passed < len(exercise.checks):
                text = "\n".join([text, *(f"({note})" for note in notes)])
            print(json.dumps({"exercise": exercise.name, "passed": passed, "report": text}), file=out, flush=True)


def _mark(
    exercise: Exercise, namespace: Mapping[str, Any], files: list[Path], task: Mapping[str, Any]
) -> tuple[int, str]:
    """Returns the number of checks that a student's function passed, and the report."""
    function = namespace.get(exercise.name)
    if not callable(function):
        names = [name for name, value in namespace.items() if callable(value) and not name.startswith("_")]
        where = ", ".join(file.name for file in files)
        text = f"there is no function of this name in {where}{did_you_mean(exercise.name, names)}"
        return 0, without_checks(exercise, text if files else "there is no .py file and no notebook")
    report = check(exercise, function, exact=task["exact"], seconds=task["seconds"])
    return sum(result.passed for result in report.results), str(report)


def _discard_output() -> None:
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.dup2(nothing, 2)


if __name__ == "__main__":
    main(json.loads(sys.argv[1]))
    os._exit(0)  # without waiting for threads and processes that the student's code started

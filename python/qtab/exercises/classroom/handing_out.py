"""``qtab.exercises.hand_out``: a notebook, or a Python file, with the tasks of several exercises."""

import json
from collections.abc import Sequence
from os import PathLike
from typing import Any

from qtab._utils import checks
from qtab._utils.files import check_writable, replacing
from qtab._utils.shown import shown
from qtab.exercises.collection import find
from qtab.exercises.exercise import Exercise

_IMPORT = "import numpy as np\n"


def hand_out(exercises: Sequence[str | int | Exercise], path: str | PathLike[str]) -> None:
    """Writes the tasks of exercises to a file for students.

    A notebook has a heading, the code to start from and a cell that checks the function for each exercise. A Python
    file has the code to start from; run as a program, it prints the reports.

    Args:
        exercises: Their names, such as ``["epsilon_greedy", "sarsa"]``, or their numbers. An exercise of your own is
            ``"module:NAME"``; to check it, students need the module as well, which contains your solution.
        path: The file to write, which ends in ``.ipynb`` or ``.py``. It is replaced if it exists.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: if there is no such exercise, if none is given, or for another suffix.
        OSError: if the file cannot be written.
    """
    file = checks.file_path("path", path)
    named = list(zip(exercises, found(exercises), strict=True))
    if file.suffix not in (".ipynb", ".py"):
        raise ValueError(f"path must end in .ipynb or .py, got {shown(str(path))}")
    check_writable("path", file)
    text = _notebook(named) if file.suffix == ".ipynb" else _program(named)
    with replacing(file) as temporary:
        temporary.write_text(text, encoding="utf-8")


def found(exercises: Sequence[str | int | Exercise]) -> list[Exercise]:
    """Returns exercises by their names or numbers.

    Raises:
        TypeError: if ``exercises`` is not a sequence, or for an exercise without a name that another process can find.
        ValueError: if there is no such exercise, if none is given, or if one is given twice.
    """
    if not checks.is_sequence(exercises):
        raise TypeError(f"exercises must be a list of names or numbers, got {shown(exercises)}")
    for one in exercises:
        if isinstance(one, Exercise) and one is not _by_name(one.name):
            raise TypeError(f"exercises must name an exercise of your own as 'module:NAME', got {one!r}")
    result = [find(one) for one in exercises]
    names = [one.name for one in result]
    if not names or len(set(names)) < len(names):
        raise ValueError(f"exercises must name each exercise once, and at least one, got {shown(list(exercises))}")
    return result


def key_of(given: str | int | Exercise) -> str:
    """Returns the word by which ``find`` finds an exercise: its name, or ``"module:NAME"``."""
    return given if isinstance(given, str) and ":" in given else find(given).name


def _by_name(name: str) -> Exercise | None:
    try:
        return find(name)
    except ValueError:
        return None


def _notebook(named: Sequence[tuple[str | int | Exercise, Exercise]]) -> str:
    cells: list[dict[str, Any]] = []
    for given, exercise in named:
        cells += [
            _cell(
                "markdown",
                f"{exercise.name}-title",
                f"# {exercise.title}\n\nSutton & Barto, section {exercise.section}.",
            ),
            _cell("code", f"{exercise.name}-code", exercise.starter.rstrip("\n")),
            _cell("code", f"{exercise.name}-check", f"import qtab\n\n{_check(given, exercise)}"),
        ]
    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    content = {"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _cell(kind: str, name: str, text: str) -> dict[str, Any]:
    cell: dict[str, Any] = {
        "cell_type": kind,
        "id": name[:64],
        "metadata": {},
        "source": text.splitlines(keepends=True),
    }
    return cell | ({"execution_count": None, "outputs": []} if kind == "code" else {})


def _program(named: Sequence[tuple[str | int | Exercise, Exercise]]) -> str:
    starters = "\n\n".join(exercise.starter.replace(_IMPORT, "").strip("\n") + "\n" for _, exercise in named)
    lines = "".join(f"    print({_check(given, exercise)})\n" for given, exercise in named)
    return f'{_IMPORT}\n\n{starters}\n\nif __name__ == "__main__":\n    import qtab\n\n{lines}'


def _check(given: str | int | Exercise, exercise: Exercise) -> str:
    return f'qtab.exercises.check("{key_of(given)}", {exercise.name})'

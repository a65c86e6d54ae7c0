"""What is run of a student's notebook: definitions, and no commands of IPython."""

import json
from pathlib import Path
from typing import Any

import pytest

from qtab.exercises.classroom.student_code import definitions


def run(folder: Path, *cells: str, names: tuple[str, ...] = ()) -> tuple[dict[str, Any], list[str]]:
    book = {"cells": [{"cell_type": "code", "source": cell.splitlines(keepends=True)} for cell in cells]}
    (folder / "homework.ipynb").write_text(json.dumps(book), encoding="utf-8")
    return definitions([folder / "homework.ipynb"], 5.0, names)


def test_lines_of_python_are_not_taken_for_commands(tmp_path: Path) -> None:
    found, notes = run(tmp_path, "def f(x):\n    y = (x\n    % 3)  # why 3?\n    return y  # and not x?")
    assert (found["f"](7), notes) == (1, [])
    line = "%matplotlib inline\n!pip install \\\n  numpy\nf?\nnp.argmax??\n?f\n"
    found, notes = run(tmp_path, f"{line}if True:\n    %cd it's\ndef f(x):\n    return (x\n    % 3)  # why 3?")
    assert (found["f"](7), notes) == (1, [])
    assert found["f"].__code__.co_firstlineno == 9


def test_code_that_is_not_python_is_named_with_its_line(tmp_path: Path) -> None:
    found, notes = run(tmp_path, "%matplotlib inline\nx = f(?", "def f(): ...")
    assert "f" in found
    assert len(notes) == 1
    assert notes[0].startswith("homework.ipynb, cell 1, line 2 is not Python: ")
    found, notes = run(tmp_path, "def f():\n    break", "def g(): ...")
    assert "g" in found
    assert notes == [
        "homework.ipynb, cell 1, line 1 raised SyntaxError: 'break' outside loop (homework.ipynb, cell 1, line 2)"
    ]


@pytest.mark.parametrize("command", ["%%time", "\n%%timeit -n 1", "%%capture out", "%%time x = 1"])
def test_a_cell_is_run_without_the_command_that_measures_it(tmp_path: Path, command: str) -> None:
    found, notes = run(tmp_path, f"{command}\ndef f(): return 1")
    assert (found["f"](), notes) == (1, [])


def test_a_cell_in_another_language_is_left_out_and_named(tmp_path: Path) -> None:
    assert run(tmp_path, "%%bash\nls", "%%time")[1] == ["homework.ipynb, cell 1 begins with %%bash and was not run"]


@pytest.mark.parametrize("assigned", ["mine", "lambda x: mine(x)", "partial(mine)", "OTHER"])
def test_an_exercise_may_be_assigned(tmp_path: Path, assigned: str) -> None:
    before = "from functools import partial\ndef mine(x): return x\nOTHER = mine\n"
    found, notes = run(tmp_path, f"{before}sarsa = {assigned}\nother = missing", names=("sarsa",))
    assert (found["sarsa"](3), notes) == (3, [])


def test_definitions_in_if_and_try_are_run_without_the_rest(tmp_path: Path) -> None:
    found, notes = run(
        tmp_path,
        "try:\n    import missing as m\n    trial()\nexcept ImportError:\n    import math as m\nfinally:\n    x()",
        "FAST = False\nif FAST:\n    STEPS = 1\nelif m.pi > 3:\n    STEPS = 2\n    trial()",
        "if True:\n    def f(): return m.floor(2.5) + STEPS\nelse:\n    def f(): ...",
        "if trial():\n    trial()",
        "if __name__ == '__main__':\n    import missing_module",
    )
    assert (found["f"](), notes) == (4, [])


def test_items_and_attributes_of_used_names_are_assigned(tmp_path: Path) -> None:
    found, notes = run(
        tmp_path,
        "class Table: pass\nTABLE, OTHER = {}, {}\nTABLE[1] = 5\nTABLE[2], _ = 6, 0\nTABLE[1] += 1\nTable.size = 3",
        "def f(): return TABLE[1] + TABLE[2] + Table.size\nOTHER[1] = missing",
    )
    assert (found["f"](), notes) == (15, [])

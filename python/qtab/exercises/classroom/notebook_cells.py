"""The Python code of a file or a notebook, without IPython's own commands."""

import ast
import json
import re
from pathlib import Path

_RUN_AS_PYTHON = ("%%time", "%%timeit", "%%capture", "%%prun")
"""Cell commands below which the cell is ordinary Python."""
_COMMAND = re.compile(r"\s*([%!?].*|[\w.]+\?{1,2}\s*)")
"""A line such as ``%matplotlib inline``, ``!pip install numpy`` or ``np.argmax?``."""


def code_parts(path: Path) -> tuple[list[tuple[str, str]], list[str]]:
    """Returns the code of a Python file, or of each cell of a notebook, with its name, and notes on cells left out.

    Lines keep their numbers.

    Raises:
        OSError: if the file cannot be read.
        ValueError: if it is not UTF-8, or a notebook is not JSON.
        KeyError: if a part of the notebook is missing.
        TypeError: if a part of the notebook has another type.
    """
    text = path.read_text(encoding="utf-8-sig")
    if path.suffix == ".py":
        return [(path.name, text)], []
    parts: list[tuple[str, str]] = []
    notes: list[str] = []
    for number, cell in enumerate(json.loads(text)["cells"]):
        if cell["cell_type"] != "code":
            continue
        name, source = f"{path.name}, cell {number + 1}", "".join(cell["source"])
        words = source.split(maxsplit=1)
        command = words[0] if words and words[0].startswith("%%") else ""
        if not command:
            parts.append((name, _python(source)))
        elif command in _RUN_AS_PYTHON:
            before, _, rest = source.partition(command)
            _, newline, code = rest.partition("\n")
            parts.append((name, _python(before + newline + code)))
        else:
            notes.append(f"{name} begins with {command} and was not run")
    return parts, notes


def _python(source: str) -> str:
    """Returns the code of a cell with ``pass`` in place of each command that is not Python.

    A line such as ``% 2`` is only taken for a command if Python finds an error in it.
    """
    lines = source.split("\n")
    while True:
        code = "\n".join(lines)
        try:
            ast.parse(code)
        except (SyntaxError, ValueError) as error:
            index = (getattr(error, "lineno", None) or 0) - 1
            if not 0 <= index < len(lines) or _COMMAND.fullmatch(lines[index]) is None:
                return code
            command = lines[index]
            lines[index] = command[: len(command) - len(command.lstrip())] + "pass"
            while command.endswith("\\") and index + 1 < len(lines):  # the command continues on the next line
                index += 1
                command, lines[index] = lines[index], ""
        else:
            return code

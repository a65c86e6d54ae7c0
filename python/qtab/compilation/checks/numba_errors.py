"""Numba's errors in a line: the user's file and line, and the reason."""

import re
from collections.abc import Iterable

from qtab.compilation.not_compilable import NotCompilable

_PLACE = re.compile(r'File "([^"\n]+)", line (\d+)|at ([^\n()]+) \((\d+)\)')
_NOISE = (
    "Failed in",
    "During",
    "- Resolution failure",
    "There are",
    "Overload",
    "- Of which",
    "With argument",
    "This error",
    "Use of unsupported",
    "Enable logging",
    "No match",
    "raised from",
    "File ",
    ">>>",
    "This is not usually",
    "To see Python",
    "https://",
    "If you think",
    "Traceback",
    "Rejected as the implementation raised a specific error:",
)
_ADVICE = (
    (">>> clip(float64", "write min(max(x, low), high)"),
    ("Unknown attribute", "use numbers, tuples and arrays, and functions of math and NumPy"),
    ("Cannot modify readonly array", "copy the array first, and return the copy"),
    ("Can't unify return type", "return equally many values everywhere, each always of one type"),
    ("Cannot unify", "give the variable values of one type"),
    ("Untyped global name", "use numbers, tuples, arrays and functions"),
)


def not_compilable(error: Exception, files: Iterable[str]) -> NotCompilable:
    """Returns the error of qtab for an error of Numba.

    Args:
        error: Numba's error.
        files: The user's files.
    """
    text = re.sub(r"\x1b\[[0-9;]*m", "", str(error))
    known = set(files)
    file, line = None, None
    for found in _PLACE.finditer(text):
        name, number = found[1] or found[3], found[2] or found[4]
        short = re.sub(r"^(?:\.\.?[/\\])+", "", name)  # Numba shortens the paths of files
        match = next((one for one in known if one.endswith(short)), None)
        if match is not None:
            file, line = match, int(number)
            break
    reason = shortened(text)
    advice = next((advice for start, advice in _ADVICE if start in text), "")
    return NotCompilable(f"Numba: {reason}", file, line, advice)


def shortened(text: str) -> str:
    """Returns the line of an error of Numba that gives the reason."""
    if "Cannot modify readonly array" in text:
        return "an array of the state, or of self, is changed"
    if "Can't unify return type" in text:
        return "its returns have different types"
    if (call := re.search(r"No implementation of function.*\n[ \n]*>>> (.*)\n", text)) is not None:
        return f"{call[1]} is not available"
    lines = [line.strip() for line in text.splitlines()]
    useful = [line for line in lines if line and not line.startswith(_NOISE)]
    # The reason of the innermost failure is the most specific one, as in "TypingError: self.rewards is a dict".
    specific = [line.partition(": ")[2] for line in useful if line.startswith(("TypingError: ", "NumbaTypeError: "))]
    specific = [line for line in specific if not line.startswith(_NOISE)]
    chosen = (specific or useful or [text or "no reason given"])[0]
    return chosen if len(chosen) <= 160 else chosen[:157] + "..."

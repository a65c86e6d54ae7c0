"""The grid world of Examples 3.5 and 3.8 in tables and pictures."""

from collections.abc import Sequence

from qtab.book.result import Line
from qtab.book.runner import FloatArray

DISCOUNT = 0.9
SIZE = 5


def as_grid(line: Line) -> FloatArray:
    """Returns (rows, columns): the numbers of a line with a point for each cell."""
    return line.mean.reshape(SIZE, SIZE)


def grid_text(lines: Sequence[Line]) -> str:
    """Returns the values of each line as they lie in the grid."""
    return "\n\n".join(f"{line.name}\n{_rows(as_grid(line))}" for line in lines)


def _rows(values: FloatArray) -> str:
    return "\n".join("".join(f"{value:7.1f}" for value in row) for row in values)

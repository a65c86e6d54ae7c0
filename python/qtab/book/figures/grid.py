"""Values of square grids, as arrays and as text."""

import math
from collections.abc import Sequence

from qtab.book.line import Line
from qtab.book.runner import FloatArray


def as_grid(line: Line) -> FloatArray:
    """Returns (rows, columns): the numbers of a line that has a point for each cell of a square."""
    return line.mean.reshape(math.isqrt(len(line.mean)), -1)


def grid_text(lines: Sequence[Line]) -> str:
    """Returns the values of each line as text, one line for each row of the grid."""
    return "\n\n".join(f"{line.name}\n{_rows(as_grid(line))}" for line in lines)


def _rows(values: FloatArray) -> str:
    return "\n".join("".join(f"{value:7.1f}" for value in row) for row in values)

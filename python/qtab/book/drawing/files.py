"""Files of the book's figures."""

from pathlib import Path
from typing import Any

from qtab.book.result import Result
from qtab.plots.axes import not_shown, save_figure

DOTS_PER_INCH = 100


def save_plot(result: Result, path: Path) -> None:
    """Draws a result to a file, completely or not at all; the suffix of the path determines the format.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        OSError: if the file cannot be written.
    """
    with not_shown():
        figure: Any = result.plot().figure
    save_figure(figure, path, DOTS_PER_INCH)

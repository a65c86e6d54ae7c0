"""Figures and axes: those that are shown, and those that only go to files."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab._utils.extras import missing
from qtab._utils.files import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_IS_SHOWN: ContextVar[bool] = ContextVar("is_shown", default=True)


def new_figure(width: float = 8, height: float = 4.5) -> "Figure":
    """Returns an empty figure that pyplot does not manage, for pictures that only go to files.

    Args:
        width: The width in inches.
        height: The height in inches.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
    """
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise missing(error, "plot") from None
    return Figure(figsize=(width, height), layout="constrained")


def shown_figure(width: float = 8, height: float = 4.5) -> "Figure":
    """Returns an empty pyplot figure, which a notebook and ``plt.show()`` show.

    Within :func:`not_shown`, pyplot does not manage it.

    Args:
        width: The width in inches.
        height: The height in inches.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
    """
    if not _IS_SHOWN.get():
        return new_figure(width, height)
    try:
        from matplotlib import pyplot as plt

        from qtab.plots.parts.shown_figure import ShownFigure
    except ModuleNotFoundError as error:
        raise missing(error, "plot") from None
    return plt.figure(figsize=(width, height), layout="constrained", FigureClass=ShownFigure)


@contextmanager
def not_shown() -> Iterator[None]:
    """A context in which plots without ``ax=`` make figures for files only: no window opens, none must be closed."""
    token = _IS_SHOWN.set(False)
    try:
        yield
    finally:
        _IS_SHOWN.reset(token)


def check_axes(ax: Any) -> None:
    """Checks that the argument ``ax`` is None or axes.

    Raises:
        TypeError: if it is neither.
    """
    if ax is None:
        return
    try:
        from matplotlib.axes import Axes
    except ModuleNotFoundError as error:
        raise missing(error, "plot") from None
    if not isinstance(ax, Axes):
        hint = f", an array of shape {ax.shape}: pass one of its axes" if isinstance(ax, np.ndarray) else f", {ax!r}"
        raise TypeError(f"ax must be a matplotlib Axes or None, got {type(ax).__name__}{hint}")


def axes_or_new(ax: "Axes | None") -> "Axes":
    """Returns the given axes, or those of a new figure, which a notebook and ``plt.show()`` show.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: if ``ax`` is neither axes nor None.
    """
    check_axes(ax)
    return shown_figure().subplots() if ax is None else ax


def check_format(name: str, path: Path) -> None:
    """Checks that the suffix of a path is an image format that matplotlib can write.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        ValueError: for another suffix; the message lists the known ones.
    """
    formats = sorted(new_figure().canvas.get_supported_filetypes())
    if path.suffix.lower().removeprefix(".") not in formats:
        raise ValueError(f"{name} must end in one of .{', .'.join(formats)}, got {str(path)!r}")


def png(figure: "Figure", dots_per_inch: int) -> bytes:
    """Returns a figure as a PNG."""
    written = io.BytesIO()
    figure.savefig(written, format="png", dpi=dots_per_inch)
    return written.getvalue()


def save_figure(figure: "Figure", path: Path, dots_per_inch: int) -> None:
    """Writes a figure to a file, completely or not at all; the suffix of the path determines the format.

    Raises:
        OSError: if the file cannot be written.
    """
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=dots_per_inch)

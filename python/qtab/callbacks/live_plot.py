"""``LivePlot``: the learning curve of a run in a notebook, while it trains."""

import importlib
import io
import time
from typing import Any

import gymnasium as gym

from qtab._utils import checks
from qtab._utils.progress import in_notebook
from qtab.config import Config
from qtab.training.callbacks import BaseCallback
from qtab.training.progress import Progress

DOTS_PER_INCH = 100


class LivePlot(BaseCallback):
    """Draws the learning curve in a notebook, as :func:`qtab.plot` does, in one picture that is replaced in place.

    Outside of a notebook it does nothing.

    Args:
        every: The number of episodes between two checks of the time; None takes ``callback_every``.
        seconds: The minimum time between two pictures, in seconds. Drawing one takes about a tenth of a second.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """

    def __init__(self, every: int | None = None, *, seconds: float = 1.0) -> None:
        super().__init__(every)
        self.seconds = checks.real("seconds", seconds, 0.0, 1e9)
        self._shows = False
        self._display: Any = None
        self._drawn = -float("inf")
        self._waiting: Progress | None = None

    def on_start(self, config: Config, env: gym.Env | None) -> None:  # noqa: ARG002
        """Begins a new picture.

        Raises:
            ModuleNotFoundError: in a notebook without matplotlib; the message names the ``pip install``.
        """
        self._shows, self._display, self._drawn = in_notebook(), None, -float("inf")
        self._waiting = None
        if self._shows:
            from qtab.plots.parts.axes import new_figure

            new_figure()  # without matplotlib this fails now, and not in the middle of the training

    def __call__(self, progress: Progress) -> None:
        """Replaces the picture, unless the last one is too recent."""
        self._waiting = progress
        if time.perf_counter() - self._drawn >= self.seconds:
            self._show()

    def on_end(self) -> None:
        """Draws the end of the run, even if another callback stopped it."""
        if self._waiting is not None and self._waiting.is_current:
            self._show()

    def _show(self) -> None:
        progress, self._waiting = self._waiting, None
        if progress is None or not self._shows:
            return
        ipython: Any = importlib.import_module("IPython.display")  # without types
        image = ipython.Image(data=_picture(progress), format="png")
        if self._display is None:
            self._display = ipython.display(image, display_id=True)
        else:
            self._display.update(image)
        self._drawn = time.perf_counter()


def _picture(progress: Progress) -> bytes:
    from matplotlib.figure import Figure

    from qtab.plots.run import plot

    figure = Figure(figsize=(8, 4.5), layout="constrained")
    ax = plot(progress.run, figure.subplots())
    ax.set_xlim(0, progress.total)  # the axis stays the same while the curve grows
    written = io.BytesIO()
    figure.savefig(written, format="png", dpi=DOTS_PER_INCH)
    return written.getvalue()

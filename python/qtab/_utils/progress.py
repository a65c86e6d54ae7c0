"""A progress bar on a terminal, or in a notebook without leaving output there, and lines printed above it."""

import sys
import time
import warnings
from collections.abc import Iterator
from functools import cache
from typing import Any

from qtab._utils.extras import missing


def in_notebook() -> bool:
    """Returns whether this code runs in a notebook kernel, which can show pictures and widgets."""
    ipython = sys.modules.get("IPython")  # a kernel has imported it
    shell = None if ipython is None else ipython.get_ipython()
    return getattr(shell, "kernel", None) is not None


def notebook_bar(**options: Any) -> Any:
    """Returns a tqdm bar as a widget, or as text if ipywidgets is not installed.

    Args:
        **options: As for ``tqdm.tqdm``.

    Raises:
        ModuleNotFoundError: without tqdm.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # tqdm warns without ipywidgets, but a text bar is enough
        from tqdm import notebook, tqdm
    if notebook.IProgress is None:
        return tqdm(**options)

    bar = _widget_class()(display=False, **options)
    if options.get("delay", 0.0) <= 0.0:
        bar.display()
    return bar


@cache
def _widget_class() -> Any:
    """Returns the class of bars in notebooks. There is only one, because tqdm starts a thread for each class."""
    from tqdm import notebook

    class WidgetProgressBar(notebook.tqdm_notebook):  # type: ignore[misc] # tqdm has no types
        """tqdm's widget, whose output can be replaced.

        tqdm closes the widget, but its output stays: a saved notebook would show the bar as it was first drawn, or an
        error where the widget was.
        """

        output: Any = None

        def display(self, *arguments: Any, check_delay: bool = True, **keywords: Any) -> None:
            """Draws the bar, and shows it once its delay is over."""
            from IPython import display

            super().display(*arguments, check_delay=False, **keywords)
            if check_delay and self.output is None:
                show: Any = display.display
                self.output = show(self.container, display_id=True)

        def close(self) -> None:
            """Closes the bar, and empties its output."""
            super().close()
            if self.output is not None:
                self.output.update({"text/plain": ""}, raw=True)
                self.output = None

    return WidgetProgressBar


SECONDS_BETWEEN_UPDATES = 0.1
"""The approximate time between two updates of the bar."""

DELAY_SECONDS = 1.0
"""The time after which a bar appears with ``progress=None``."""

_bars: list[Any] = []
"""The tqdm bars in use."""


class ProgressBar:
    """The progress of a long call, as a context manager: on standard error, or as a widget in a notebook.

    Without a bar, it does nothing.

    Args:
        total: The number of units to do; None if it is not known.
        unit: The name of a unit, in the singular.
        progress: True shows the bar at once, False never. None shows it after a second, if standard error is a terminal
            or a notebook's, and tqdm is installed.
        description: The text before the bar.
        done: The number of units that are finished already.

    Raises:
        ModuleNotFoundError: if ``progress`` is True and tqdm is not installed; the message names the ``pip install``.
        TypeError: if ``progress`` is neither a boolean nor None.
    """

    def __init__(
        self, total: int | None, unit: str, progress: bool | None, description: str | None = None, done: int = 0
    ) -> None:
        self._bar = _tqdm(total, unit, progress, description)
        self._done, self._stride = done, 1

    # A class, because contextlib's generator-based context managers set attributes of exceptions that pass through
    # them, which a frozen exception does not allow.
    def __enter__(self) -> "ProgressBar":
        if self._bar is not None:
            _bars.append(self._bar)
            if self._done:
                self.move_to(self._done)
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            _bars.remove(self._bar)
            self._bar.close()

    @property
    def is_shown(self) -> bool:
        """Whether there is a bar, now or after its delay."""
        return self._bar is not None

    def chunks(self, done: int, target: int) -> Iterator[int]:
        """Yields the counts to work up to in turn, from ``done`` to ``target``.

        With a bar, the counts are about a tenth of a second apart, and the bar moves in between. Without one, the only
        count is ``target``.
        """
        if self._bar is None:
            yield target
            return
        while done < target:
            started, before = time.perf_counter(), done
            done = min(done + self._stride, target)
            yield done
            self._bar.update(done - before)
            seconds = time.perf_counter() - started
            # Episodes become longer or shorter as a run learns, so the stride adapts by factors of two.
            factor = 2.0 if seconds < SECONDS_BETWEEN_UPDATES / 2 else 0.5 if seconds > SECONDS_BETWEEN_UPDATES else 1.0
            self._stride = max(1, int(self._stride * factor))

    def move_to(self, done: int) -> None:
        """Shows that ``done`` units are finished."""
        if self._bar is not None:
            self._bar.update(done - self._bar.n)


def check_progress(progress: Any) -> None:
    """Checks the argument ``progress``, before the function may show a bar.

    Raises:
        TypeError: if ``progress`` is neither a boolean nor None.
    """
    if not (progress is None or isinstance(progress, bool)):
        raise TypeError(f"progress must be True, False or None, got {progress!r}")


def _tqdm(total: int | None, unit: str, progress: bool | None, description: str | None) -> Any:
    check_progress(progress)
    is_terminal = sys.stderr is not None and sys.stderr.isatty()
    if progress is False or (progress is None and not is_terminal and not in_notebook()):
        return None
    options = {
        "total": total,
        "unit": f" {unit}s",
        "desc": description,
        "delay": 0.0 if progress else DELAY_SECONDS,
        "leave": False,
        "dynamic_ncols": True,
    }
    try:
        if in_notebook():
            return notebook_bar(**options)
        from tqdm import tqdm
    except ModuleNotFoundError as error:
        if progress:
            raise missing(error, "cli") from None
        return None
    return tqdm(**options)


def print_above(line: str) -> None:
    """Prints a line on standard output, above the progress bar if there is one."""
    # tqdm.write would also draw a bar that still waits for its delay, and leave it on the screen.
    drawn = [bar for bar in _bars if bar.delay == 0 or bar.last_print_t > bar.start_t]
    if drawn:
        drawn[-1].write(line, file=sys.stdout)
        sys.stdout.flush()
    else:
        print(line, flush=True)  # noqa: T201 - its purpose

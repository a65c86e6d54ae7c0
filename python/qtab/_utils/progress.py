"""A progress bar on a terminal, for runs that take long enough to want one."""

import sys
import time
from collections.abc import Iterator
from typing import Any

from qtab._utils.extras import missing

SECONDS_BETWEEN_UPDATES = 0.1
"""About how long a run goes on between two looks at the bar."""

DELAY_SECONDS = 1.0
"""A bar that nobody asked for appears after so long."""

_open: list[Any] = []
"""The tqdm bars in use, which lines are written around."""


class ProgressBar:
    """How far a long call is, on standard error. A context; without a bar to show, it does nothing.

    Args:
        total: How many there are to do.
        unit: What is counted.
        progress: True shows it at once, False never; None shows it on a terminal, after a second, with tqdm installed.
        description: What stands before it.

    Raises:
        ModuleNotFoundError: if a bar is asked for and tqdm is not installed; it names the ``pip install``.
        TypeError: if ``progress`` is none of the three.
    """

    def __init__(self, total: int, unit: str, progress: bool | None, description: str | None = None) -> None:
        self._shown = _tqdm(total, unit, progress, description)
        self._stride = 1

    # Not a generator: contextlib writes to the exceptions that pass through one, and a frozen one refuses.
    def __enter__(self) -> "ProgressBar":
        if self._shown is not None:
            _open.append(self._shown)
        return self

    def __exit__(self, *_: object) -> None:
        if self._shown is not None:
            _open.remove(self._shown)
            self._shown.close()

    def chunks(self, done: int, target: int) -> Iterator[int]:
        """Yields where to pause on the way to ``target``: nowhere, or about ten times a second to move the bar."""
        if self._shown is None:
            yield target
            return
        while done < target:
            began, before = time.perf_counter(), done
            done = min(done + self._stride, target)
            yield done
            self._shown.update(done - before)
            seconds = time.perf_counter() - began
            # Twice or half as many at a time: an episode's length changes while a run learns.
            factor = 2.0 if seconds < SECONDS_BETWEEN_UPDATES / 2 else 0.5 if seconds > SECONDS_BETWEEN_UPDATES else 1.0
            self._stride = max(1, int(self._stride * factor))

    def move_to(self, done: int) -> None:
        """Shows that so many are done."""
        if self._shown is not None:
            self._shown.update(done - self._shown.n)


def _tqdm(total: int, unit: str, progress: bool | None, description: str | None) -> Any:
    if not (progress is None or isinstance(progress, bool)):
        raise TypeError(f"progress must be True, False or None, got {progress!r}")
    if progress is False or (progress is None and not on_terminal(sys.stderr)):
        return None
    try:
        from tqdm import tqdm
    except ModuleNotFoundError as error:
        if progress:
            raise missing(error, "cli") from None
        return None
    delay = 0.0 if progress else DELAY_SECONDS
    return tqdm(total=total, unit=f" {unit}s", desc=description, delay=delay, leave=False, dynamic_ncols=True)


def on_terminal(stream: Any) -> bool:
    """Whether a stream is one that a person watches."""
    return stream is not None and stream.isatty()


def print_above(line: str) -> None:
    """Prints a line on standard output, above the bar where there is one."""
    # tqdm.write draws a bar anew even if it still waits to appear, and would leave it there.
    drawn = [shown for shown in _open if shown.delay == 0 or shown.last_print_t > shown.start_t]
    if drawn:
        drawn[-1].write(line, file=sys.stdout)
    else:
        print(line, flush=True)  # noqa: T201 - what it is for

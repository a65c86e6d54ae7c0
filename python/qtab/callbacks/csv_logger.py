"""``CSVLogger``: the progress of a run as a CSV file."""

import csv
import os
from collections.abc import Iterable
from typing import TextIO

import gymnasium as gym

from qtab._utils.files import check_writable
from qtab.callbacks.checkpoint import file_path
from qtab.callbacks.evaluate_every import EvaluateEvery
from qtab.callbacks.metrics import EVALUATION, MetricsLogger
from qtab.config import Config
from qtab.training.callbacks import Progress


class CSVLogger(MetricsLogger):
    """Writes a line of numbers at intervals and at the end, each of which can be read at once.

    The first line has the names: ``episodes``, the number of finished ones, and the metrics. Numbers have all their
    digits; a cell without a value is empty. A file that is there already is replaced.

    Args:
        path: The file, such as ``"log.csv"``.
        every: The number of episodes between two lines; None takes ``callback_every``.
        metrics: The names of what to write, in this order: among ``"steps"`` and ``"seconds"`` since the run began,
            ``"mean_return"`` and ``"mean_length"`` of the episodes since the last line, and ``"epsilon"`` and
            ``"learning_rate"`` of the last episode. None writes all of them.
        evaluation: A callback that evaluates the run, whose mean returns are the column ``evaluation_return``. It
            belongs before the logger in the list of callbacks.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or an unknown metric.
    """

    def __init__(
        self,
        path: "str | os.PathLike[str]",
        every: int | None = None,
        *,
        metrics: Iterable[str] | None = None,
        evaluation: EvaluateEvery | None = None,
    ) -> None:
        super().__init__(every, metrics, evaluation)
        self.path = file_path("path", path)
        self._file: TextIO | None = None

    def on_start(self, config: Config, env: gym.Env | None) -> None:
        """Creates the file, with the line of names.

        Raises:
            OSError: if the file cannot be written.
        """
        super().on_start(config, env)
        check_writable("path", self.path)
        self._file = self.path.open("w", encoding="utf-8", newline="")
        self._write("episodes", *self.metrics, *([EVALUATION] if self.evaluation else []))

    def __call__(self, progress: Progress) -> None:
        """Writes a line."""
        self._write(progress.episodes, *self.measure(progress).values())

    def on_end(self) -> None:
        """Closes the file."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def _write(self, *cells: str | float | None) -> None:
        if self._file is not None:
            csv.writer(self._file, lineterminator="\n").writerow(cells)
            self._file.flush()

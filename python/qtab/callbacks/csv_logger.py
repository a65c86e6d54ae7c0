"""``CSVLogger``: the progress of a run as a CSV file."""

import csv
import os
from collections.abc import Iterable

from qtab._utils.files import check_writable
from qtab.callbacks.checkpoint import file_path
from qtab.callbacks.evaluate_every import EvaluateEvery
from qtab.callbacks.metrics import EVALUATION, MetricsLogger
from qtab.config import Config
from qtab.training.progress import Progress


class CSVLogger(MetricsLogger):
    """Writes a line of numbers at intervals and at the end, and flushes the file after each.

    The first line has the names of the columns: ``episodes``, the number of finished episodes, and the metrics. Numbers
    have all their digits; a cell without a value is empty. An existing file is replaced; when a run is resumed, the
    lines for the episodes that it had finished are kept.

    Args:
        path: The file, such as ``"log.csv"``.
        every: The number of episodes between two lines; None takes ``callback_every``.
        metrics: The names of the metrics to write, in order: of ``"steps"`` and ``"seconds"`` since the run began,
            ``"mean_return"`` and ``"mean_length"`` of the episodes since the last line, and ``"epsilon"`` and
            ``"learning_rate"`` of the last episode. None writes all of them.
        evaluation: A callback that evaluates the run, whose mean returns are the column ``evaluation_return``. It
            must come before the logger in the list of callbacks.

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

    def _start(self, config: Config, finished: int) -> None:
        lines = self._lines(finished) if finished else []
        super()._start(config, int(lines[-1][0]) if lines else finished)
        check_writable("path", self.path)
        self._log = self.path.open("w", encoding="utf-8", newline="")
        for line in (self._names, *lines):
            self._write(*line)

    def __call__(self, progress: Progress) -> None:
        """Writes a line."""
        self._write(progress.episodes, *self.measure(progress).values())

    @property
    def _names(self) -> list[str]:
        return ["episodes", *self.metrics, *([EVALUATION] if self.evaluation else [])]

    def _lines(self, finished: int) -> list[list[str]]:
        """Returns the lines of the file up to ``finished`` episodes, without the names; none if there is no file."""
        if not self.path.is_file():
            return []
        # The last line may have been cut off when the process was killed.
        whole, _, _ = self.path.read_text(encoding="utf-8").rpartition("\n")
        names, *lines = filter(None, csv.reader(whole.splitlines() or [",".join(self._names)]))
        if names != self._names:
            raise ValueError(
                f"path must be the log of the earlier part, with the columns {', '.join(self._names)}, got "
                f"{str(self.path)!r} with {', '.join(names)}"
            )
        return [line for line in lines if int(line[0]) <= finished]

    def _write(self, *cells: str | float | None) -> None:
        if self._log is not None:
            csv.writer(self._log, lineterminator="\n").writerow(cells)
            self._log.flush()

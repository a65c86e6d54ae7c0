"""``TensorBoardLogger``: the progress of a run as curves in TensorBoard."""

import os
from collections.abc import Iterable

from qtab._utils import checks
from qtab._utils.extras import missing
from qtab.callbacks.evaluate_every import EvaluateEvery
from qtab.callbacks.metrics import MetricsLogger
from qtab.config import Config
from qtab.training.progress import Progress


class TensorBoardLogger(MetricsLogger):
    """Writes the metrics of a run to a folder that ``tensorboard --logdir`` shows, over the number of episodes.

    It needs tensorboardX, which writes TensorBoard's files without TensorBoard. When a run is resumed, the curves of
    its earlier part continue.

    Args:
        folder: The folder, created if it is missing. A run adds a file; use one folder per run to tell runs apart.
        every: The number of episodes between two points; None takes ``callback_every``.
        metrics: The names of the metrics to write: those of :class:`qtab.callbacks.CSVLogger`. None writes all of them.
        evaluation: A callback that evaluates the run, whose mean returns are the curve ``evaluation_return``. It
            must come before the logger in the list of callbacks.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or an unknown metric.
    """

    def __init__(
        self,
        folder: "str | os.PathLike[str]",
        every: int | None = None,
        *,
        metrics: Iterable[str] | None = None,
        evaluation: EvaluateEvery | None = None,
    ) -> None:
        super().__init__(every, metrics, evaluation)
        self.folder = checks.path("folder", folder)

    def _start(self, config: Config, finished: int) -> None:
        super()._start(config, finished)
        try:
            from tensorboardX import SummaryWriter
        except ModuleNotFoundError as error:
            raise missing(error, "tensorboard") from None
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise type(error)(f"folder must be a folder, got {str(self.folder)!r}: {error.strerror}") from None
        # TensorBoard drops the points of earlier files from `purge_step` on. The suffix distinguishes two files of the
        # same second.
        again = {"purge_step": finished + 1, "filename_suffix": f".{finished}"} if finished else {}
        self._log = SummaryWriter(str(self.folder), **again)
        settings = "\n".join(f"    {name} = {value!r}" for name, value in vars(config).items() if value is not None)
        self._log.add_text("settings", settings, finished)

    def __call__(self, progress: Progress) -> None:
        """Adds a point to each curve."""
        for name, value in self.measure(progress).items():
            if value is not None:
                self._log.add_scalar(name, value, progress.episodes)

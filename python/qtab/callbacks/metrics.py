"""The numbers that the loggers write."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import did_you_mean
from qtab.callbacks.evaluate_every import EvaluateEvery
from qtab.config import Config
from qtab.training.callbacks import BaseCallback
from qtab.training.progress import Progress

if TYPE_CHECKING:
    from qtab.results.run import Run


METRICS = ("steps", "mean_return", "mean_length", "epsilon", "learning_rate", "seconds")
"""The steps and seconds since the run began; the mean return and length of the episodes since the last line; and the
exploration rate and learning rate of the last episode."""

EVALUATION = "evaluation_return"
"""The name of the mean return of an evaluation, for a logger with ``evaluation``."""


class MetricsLogger(BaseCallback):
    """The base class of the loggers, which compute the same metrics and write them to different places.

    Args:
        every: The number of episodes between two lines; None takes ``callback_every``.
        metrics: The names of the metrics to write, in order.
        evaluation: A callback that evaluates the run, whose mean returns are written too. It must come before the
            logger in the list of callbacks.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or an unknown metric.
    """

    def __init__(self, every: int | None, metrics: Iterable[str] | None, evaluation: EvaluateEvery | None) -> None:
        super().__init__(every)
        if evaluation is not None and not isinstance(evaluation, EvaluateEvery):
            raise TypeError(f"evaluation must be an EvaluateEvery or a KeepBest, got {evaluation!r}")
        self.metrics = METRICS if metrics is None else check_metrics(metrics)
        self.evaluation = evaluation
        self._episodes = self._evaluations = 0
        self._log: Any = None
        """The open file or writer."""

    def on_start(self, config: Config, env: gym.Env | None) -> None:  # noqa: ARG002
        """Begins a log.

        Raises:
            ModuleNotFoundError: without the library that writes it; the message names the ``pip install``.
            OSError: if it cannot be written.
        """
        self._start(config, 0)

    def on_resume(self, config: Config, env: gym.Env | None, earlier: "Run") -> None:  # noqa: ARG002
        """Continues the log of the earlier part, without its entries for episodes after those that are resumed.

        Raises:
            ModuleNotFoundError: as for :meth:`on_start`.
            OSError: if it cannot be read or written.
            ValueError: if it is the log of other metrics.
        """
        self._start(config, len(earlier.episode_returns))

    def _start(self, config: Config, finished: int) -> None:  # noqa: ARG002
        """Begins a log, or continues one after ``finished`` episodes."""
        # An evaluation callback, which comes before the logger, has continued its evaluations already.
        self._evaluations = len(self.evaluation.evaluations) if finished and self.evaluation else 0
        self._episodes = finished

    def on_end(self) -> None:
        """Closes the log."""
        if self._log is not None:
            self._log.close()
            self._log = None

    def measure(self, progress: Progress) -> dict[str, float | int | None]:
        """Returns the metrics of the episodes since the last call; None if there is no value."""
        since, self._episodes = self._episodes, progress.episodes
        means = {"mean_return": _mean(progress.returns[since:]), "mean_length": _mean(progress.lengths[since:])}
        values = {name: means[name] if name in means else getattr(progress, name) for name in self.metrics}
        if self.evaluation is not None:
            evaluations = self.evaluation.evaluations
            before, self._evaluations = self._evaluations, len(evaluations)
            values[EVALUATION] = evaluations[-1].mean_return if len(evaluations) > before else None
        return values


def check_metrics(metrics: Iterable[str]) -> tuple[str, ...]:
    """Checks the names of metrics and returns them.

    Raises:
        TypeError: if they are not a sequence of strings.
        ValueError: for an unknown one, or if there is none.
    """
    if isinstance(metrics, str) or not isinstance(metrics, Iterable):
        raise TypeError(f"metrics must be a sequence of names, got {metrics!r}")
    names = tuple(metrics)
    for name in names:
        if name not in METRICS:
            raise ValueError(
                f"metrics must be among {', '.join(map(repr, METRICS))}, got {name!r}{did_you_mean(str(name), METRICS)}"
            )
    if not names:
        raise ValueError("metrics must hold at least one name, got none")
    return names


def _mean(values: "NDArray[np.float64] | NDArray[np.int64]") -> float | None:
    return float(values.mean()) if len(values) else None

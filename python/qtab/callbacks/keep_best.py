"""``KeepBest``: keeps the run of the best evaluation."""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import gymnasium as gym

from qtab._utils.files import check_writable
from qtab.callbacks.checkpoint import file_path, first_part, is_first_part
from qtab.callbacks.evaluate_every import EvaluateEvery
from qtab.config import Config
from qtab.training.progress import Progress

if TYPE_CHECKING:
    from qtab.results.run import Run


class KeepBest(EvaluateEvery):
    """Evaluates the greedy policy as :class:`EvaluateEvery` does, and keeps the run as it was at the best evaluation.

    The mean return of the best of many evaluations is too optimistic: report the result of a new :func:`qtab.evaluate`.

    Args:
        path: The file to save the run to, whenever there is a better one; None does not save it.
        episodes: The number of episodes of each evaluation.
        every: The number of training episodes between two evaluations; None takes ``callback_every``.
        seed: The seed of the environment, as for :class:`EvaluateEvery`.
        env: The environment to evaluate in, as for :class:`EvaluateEvery`.

    Attributes:
        run: The run as it was at the evaluation with the highest mean return, the first if several are equal; its
            ``q_table`` and :func:`qtab.evaluate` are those of that time. None before the first evaluation.
        best_return: The mean return of that evaluation; None before the first one.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """

    def __init__(
        self,
        path: "str | os.PathLike[str] | None" = None,
        episodes: int = 20,
        every: int | None = 1000,
        *,
        seed: int | None = None,
        env: gym.Env | None = None,
    ) -> None:
        super().__init__(episodes, every, seed=seed, env=env)
        self.path: Path | None = None if path is None else file_path("path", path)
        self.run: Run | None = None
        self.best_return: float | None = None

    def on_start(self, config: Config, env: gym.Env | None) -> None:
        """Discards the evaluations and the best run of an earlier run.

        Raises:
            OSError: if the file cannot be written.
            ValueError: if there is no environment to evaluate in except the one that is trained in.
        """
        super().on_start(config, env)
        if self.path is not None:
            check_writable("path", self.path)
        self.run = self.best_return = None

    def on_resume(self, config: Config, env: gym.Env | None, earlier: "Run") -> None:
        """Continues with the best run of the earlier part, if this object or its file holds it; else without one.

        Raises:
            OSError: if the file cannot be written.
            ValueError: as for :meth:`on_start`.
        """
        held = self.run
        super().on_resume(config, env, earlier)
        if held is None or not self.evaluations or not is_first_part(held, earlier):
            held = None if self.path is None else first_part(self.path, earlier)
        if held is not None:
            self.run, self.best_return = held, self._evaluate(held).mean_return

    def __call__(self, progress: Progress) -> bool | None:
        """Evaluates the greedy policy, and keeps the run if it is the best so far."""
        proceed = super().__call__(progress)
        mean = self.evaluations[-1].mean_return
        if self.best_return is None or mean > self.best_return:
            self.run, self.best_return = progress.run, mean
            if self.path is not None:
                self.run.save(self.path)
        return proceed

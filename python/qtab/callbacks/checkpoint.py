"""``Checkpoint``: saves a run while it is in progress."""

import os
from pathlib import Path

import gymnasium as gym

from qtab._utils import checks
from qtab._utils.files import check_writable
from qtab.callbacks.base import BaseCallback
from qtab.config import Config
from qtab.training.callbacks import Progress


class Checkpoint(BaseCallback):
    """Saves the run so far to a file that :func:`qtab.load` reads, at intervals and at the end.

    A file is written completely or not at all: if the process is killed meanwhile, the previous one stays.

    Args:
        path: The file, such as ``"run.npz"``.
        every: The number of episodes between two checkpoints; None takes ``callback_every``.
        numbered: Whether to keep the earlier ones too, with the number of episodes in the name:
            ``run-1000.npz``, ``run-2000.npz``.
        keep: How many of the numbered files to keep, the last ones; None keeps all.

    Attributes:
        saved: The files of this run that are there, oldest first.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or ``keep`` without ``numbered``.
    """

    def __init__(
        self,
        path: "str | os.PathLike[str]",
        every: int | None = 1000,
        *,
        numbered: bool = False,
        keep: int | None = None,
    ) -> None:
        super().__init__(every)
        self.path = file_path("path", path)
        if not isinstance(numbered, bool):
            raise TypeError(f"numbered must be True or False, got {numbered!r}")
        if keep is not None and not numbered:
            raise ValueError(f"keep applies to numbered=True, where there are several files, got {keep!r}")
        self.numbered = numbered
        self.keep = None if keep is None else checks.integer("keep", keep, least=1)
        self.saved: list[Path] = []

    def on_start(self, config: Config, env: gym.Env | None) -> None:  # noqa: ARG002
        """Begins anew.

        Raises:
            OSError: if the file cannot be written.
        """
        check_writable("path", self.path)
        self.saved = []

    def __call__(self, progress: Progress) -> None:
        """Saves the run, and removes the files that are too many."""
        target = self._target(progress)
        progress.run.save(target)
        self.saved = [path for path in self.saved if path != target] + [target]
        if self.keep is not None:
            for path in self.saved[: -self.keep]:
                path.unlink(missing_ok=True)
            self.saved = self.saved[-self.keep :]

    def _target(self, progress: Progress) -> Path:
        if not self.numbered:
            return self.path
        width = len(str(progress.total))  # so that the names sort by their numbers
        return self.path.with_name(f"{self.path.stem}-{progress.episodes:0{width}d}{self.path.suffix}")


def file_path(name: str, path: "str | os.PathLike[str]") -> Path:
    """Returns the path of a file that a callback writes.

    Raises:
        TypeError: if it is not a path.
        ValueError: if it names no file.
    """
    target = checks.path(name, path)
    if not target.name:
        raise ValueError(f"{name} must name a file, got {str(path)!r}")
    return target

"""``Checkpoint``: saves a run while it is in progress."""

import glob
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium as gym

from qtab._utils import checks
from qtab._utils.files import check_writable
from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.training.callbacks import BaseCallback
from qtab.training.progress import Progress

if TYPE_CHECKING:
    from qtab.results.run import Run


class Checkpoint(BaseCallback):
    """Saves the run so far to a file that :func:`qtab.load` reads, at intervals and at the end.

    A file is written completely or not at all: if the process is killed meanwhile, the previous one stays.

    Args:
        path: The file, such as ``"run.npz"``.
        every: The number of episodes between two checkpoints; None takes ``callback_every``.
        numbered: Whether to keep the earlier ones too, with the number of episodes in the name:
            ``run-1000.npz``, ``run-2000.npz``.
        keep: The number of numbered files to keep, the last ones; None keeps all. Files of the earlier part of a
            resumed run count too.

    Attributes:
        saved: The existing files of this run, oldest first.

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
        """Starts without saved files.

        Raises:
            OSError: if the file cannot be written.
        """
        check_writable("path", self.path)
        self.saved = []

    def on_resume(self, config: Config, env: gym.Env | None, earlier: "Run") -> None:
        """Finds the numbered files of the earlier part.

        Raises:
            OSError: if the file cannot be written.
        """
        self.on_start(config, env)
        if self.numbered:
            self.saved = [path for _, path in sorted(self._saved_of(earlier))]

    def _saved_of(self, earlier: "Run") -> Iterator[tuple[int, Path]]:
        """Yields the number and the path of each numbered file that holds the first episodes of a run."""
        for path in self.path.parent.glob(f"{glob.escape(self.path.stem)}-*{glob.escape(self.path.suffix)}"):
            number = path.stem.removeprefix(f"{self.path.stem}-")
            if number.isdecimal() and first_part(path, earlier) is not None:
                yield int(number), path

    def __call__(self, progress: Progress) -> None:
        """Saves the run, and removes the oldest files beyond ``keep``."""
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


def first_part(path: Path, run: "Run") -> "Run | None":
    """Returns the run in a file if it holds the first episodes of a run; None for any other file."""
    from qtab.results.files.loading import load

    # A file does not store the functions of its run.
    functions: dict[str, Any] = {
        name: setting for name in ("discretizer", "action_mask") if callable(setting := getattr(run.config, name))
    }
    with suppress(OSError, TypeError, ValueError):  # not the file of such a run
        found = load(path, **functions)
        return found if is_first_part(found, run) else None
    return None


def is_first_part(part: "Run", run: "Run") -> bool:
    """Returns whether a run holds the first episodes of another one."""
    count = len(part.episode_returns)
    return replace_checked(part.config, episodes=run.config.episodes) == run.config and all(
        getattr(part, name).tobytes() == getattr(run, name)[:count].tobytes()
        for name in ("episode_returns", "episode_lengths")
    )


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

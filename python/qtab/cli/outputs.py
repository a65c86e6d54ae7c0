"""The files, the window and the videos of ``qtab train``: checked before the training, written after it."""

from argparse import Namespace
from contextlib import ExitStack, closing
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from qtab._utils import checks
from qtab._utils.files import check_writable
from qtab._utils.shown import counted, last_of
from qtab.callbacks import Checkpoint
from qtab.cli.reporting import Report
from qtab.config import Config
from qtab.rendering.replay import replay_all
from qtab.rendering.video import VideoRecorder
from qtab.rendering.window import display_problem, open_window
from qtab.results.run import Run
from qtab.training.progress import Callback

if TYPE_CHECKING:
    from qtab.planning import Optimum

DEFAULT_SHOWN = 20
"""The number of episodes that ``--record`` writes without ``--watch``, as many as the article's code shows."""


class Outputs:
    """The output files of a run, and its window. A context manager, which closes the window and the videos.

    Args:
        config: The resolved config of the run.
        asked: The arguments ``save``, ``plot``, ``checkpoint``, ``watch`` and ``record``; each is None if not given.
        report: The report to print the written files to.

    Raises:
        ModuleNotFoundError: if an optional library is missing; it names the ``pip install``.
        OSError: if a path cannot be written.
        ValueError: if there is no display for the window, or the environment cannot be rendered.
    """

    def __init__(self, config: Config, asked: Namespace, report: Report) -> None:
        self._save, self._plot, self._record, self._say = asked.save, asked.plot, asked.record, report.text
        self.files: dict[str, Path] = {}
        """The written files, by the argument that asked for each."""
        self.written: list[str] = []
        """Lines to print about the files that :meth:`keep` wrote."""
        report.writes_files = any(path is not None for path in (asked.save, asked.plot, asked.record))
        if asked.watch is not None:
            checks.integer("watch", asked.watch, least=1)
        if asked.plot is not None:
            from qtab.plots.parts.axes import check_format

            check_format("plot", asked.plot)
            check_writable("plot", asked.plot)
        if asked.save is not None:
            check_writable("save", asked.save)
        self.callbacks: tuple[Callback, ...] = ()
        """The callbacks that save the run while it is in progress."""
        if asked.checkpoint is not None:
            if asked.save is None:
                raise ValueError("--checkpoint needs --save, the file that it writes")
            self.callbacks = (Checkpoint(asked.save, checks.integer("checkpoint", asked.checkpoint, least=1)),)
        self.shown = asked.watch or (0 if asked.record is None else DEFAULT_SHOWN)
        """The number of last episodes to replay."""
        with ExitStack() as opened:
            window, folder = asked.watch is not None, asked.record
            if window and folder is not None and (problem := display_problem()) is not None:
                raise ValueError(f"watch needs a display ({problem}); leave out --watch: --record works without one")
            self._screen = opened.enter_context(closing(open_window(config))) if window else None
            self._recorder = None if folder is None else opened.enter_context(closing(VideoRecorder(config, folder)))
            self._opened = opened.pop_all()

    def __enter__(self) -> "Outputs":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._opened.__exit__(kind, error, traceback)

    def keep(self, run: Run, optimum: "Optimum | None" = None) -> None:
        """Saves and plots a run, finished or interrupted. Prints nothing, as that may fail: ``written`` has the lines.

        Raises:
            OSError: if a file cannot be written.
        """
        if self._save is not None:
            run.save(self._save)
            self.files["save"] = self._save
            self.written.append(f"Saved the run to {self._save}")
        if self._plot is not None:
            from qtab.plots.run import save_plot

            save_plot(run, self._plot, optimum)
            self.files["plot"] = self._plot
            self.written.append(f"Saved the plot to {self._plot}")

    def show(self, run: Run) -> None:
        """Replays the recorded episodes in videos and in the window."""
        different = 0
        if self._recorder is not None:
            different = self._recorder.record(run)
            self.files["record"] = self._record
            self._say(f"Saved {counted(len(run.recordings), 'video')} to {self._record}")
        if self._screen is not None:
            self._say(f"Showing the {last_of(len(run.recordings), 'episode')}")
            different = replay_all(self._screen, run)
        if different:
            returned = f"{different} of them had another return than in training"
            self._say(f"{returned}: the environment keeps state besides its random generator")

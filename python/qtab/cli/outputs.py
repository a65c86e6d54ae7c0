"""The files, the window and the videos of ``qtab train``: checked before the training, written after it."""

from collections.abc import Callable
from contextlib import ExitStack, closing
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from qtab._utils import checks
from qtab._utils.files import check_writable
from qtab._utils.progress import print_above
from qtab._utils.shown import counted
from qtab.callbacks import Checkpoint
from qtab.config import Config
from qtab.rendering.replay import replay_all
from qtab.rendering.video import VideoRecorder
from qtab.rendering.window import display_problem, open_window
from qtab.results.run import Run
from qtab.training.callbacks import Callback

if TYPE_CHECKING:
    from qtab.planning import Optimum

DEFAULT_SHOWN = 20
"""The number of episodes that ``--record`` writes without ``--watch``, as many as the article's code shows."""


class Outputs:
    """The output files of a run, and its window. A context manager, which closes the window and the videos.

    Args:
        config: The resolved config of the run.
        save: The file to save the run to, or None.
        plot: The file to draw the learning curve to, or None.
        watch: The number of last episodes to show in a window, or None.
        record: The folder for videos of the last episodes, or None.
        say: Prints a line about what was written.
        checkpoint: The number of episodes after which to save the run so far to ``save`` each time, or None.

    Raises:
        ModuleNotFoundError: if an optional library is missing; it names the ``pip install``.
        OSError: if a path cannot be written.
        ValueError: if there is no display for the window, or the environment cannot be rendered.
    """

    def __init__(
        self,
        config: Config,
        save: Path | None,
        plot: Path | None,
        watch: int | None,
        record: Path | None,
        say: Callable[[str], None] = print_above,
        checkpoint: int | None = None,
    ) -> None:
        self._save, self._plot, self._record, self._say = save, plot, record, say
        self.files: dict[str, Path] = {}
        """What was written, by the argument that asked for it."""
        self.written: list[str] = []
        """Lines about what :meth:`keep` wrote, to be printed."""
        self.has_files = save is not None or plot is not None or record is not None
        """Whether there is anything to write."""
        if watch is not None:
            checks.integer("watch", watch, least=1)
        if plot is not None:
            from qtab.plots.axes import check_format

            check_format("plot", plot)
            check_writable("plot", plot)
        if save is not None:
            check_writable("save", save)
        self.callbacks: tuple[Callback, ...] = ()
        """What saves the run while it is in progress."""
        if checkpoint is not None:
            if save is None:
                raise ValueError("--checkpoint needs --save, the file that it writes")
            self.callbacks = (Checkpoint(save, checks.integer("checkpoint", checkpoint, least=1)),)
        self.shown = watch or (DEFAULT_SHOWN if record is not None else 0)
        """The number of last episodes to replay."""
        with ExitStack() as opened:
            if watch is not None and record is not None and (problem := display_problem()) is not None:
                raise ValueError(f"watch needs a display ({problem}); leave out --watch: --record works without one")
            self._screen = None if watch is None else opened.enter_context(closing(open_window(config)))
            self._recorder = None if record is None else opened.enter_context(closing(VideoRecorder(config, record)))
            self._opened = opened.pop_all()

    def __enter__(self) -> "Outputs":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._opened.__exit__(kind, error, traceback)

    def keep(self, run: Run, optimum: "Optimum | None" = None) -> None:
        """Saves and plots a run, finished or interrupted. It prints nothing, which may fail: ``written`` says where.

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
        if self._recorder is not None and self._record is not None:
            different = self._recorder.record(run)
            self.files["record"] = self._record
            self._say(f"Saved {counted(len(run.recordings), 'video')} to {self._record}")
        if self._screen is not None:
            self._say(f"Showing {last_episodes(len(run.recordings))}")
            different = replay_all(self._screen, run)
        if different:
            returned = f"{different} of them returned something else than in training"
            self._say(f"{returned}: the environment keeps state besides its random generator")


def last_episodes(count: int) -> str:
    """Returns ``the last episode`` or, for more, ``the last 100 episodes``."""
    return "the last episode" if count == 1 else f"the last {counted(count, 'episode')}"

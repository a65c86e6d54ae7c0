"""What a training command leaves behind: checked before the training, written after it."""

from contextlib import ExitStack, closing
from pathlib import Path
from types import TracebackType

from qtab._utils import checks
from qtab._utils.files import check_writable
from qtab._utils.progress import print_above
from qtab.config import Config
from qtab.planning import Optimum
from qtab.plots.axes import check_format
from qtab.plots.run import save_plot
from qtab.rendering.replay import replay_all
from qtab.rendering.video import VideoRecorder
from qtab.rendering.window import open_window
from qtab.results.run import Run

DEFAULT_SHOWN = 20
"""As many episodes as the article's code shows."""


class Outputs:
    """Files, a window, videos. A context: it closes what it opened.

    Args:
        config: The resolved config of the run to come.
        save: Where the run goes; None nowhere.
        plot: Where the picture goes; None nowhere.
        watch: How many episodes to show in a window; None shows none.
        record: Where videos of them go; None nowhere.

    Raises:
        ModuleNotFoundError: if an optional library is missing; it names the ``pip install``.
        OSError: if a path cannot be written.
        ValueError: if there is no display to watch on, or a picture cannot be made.
    """

    def __init__(
        self, config: Config, save: Path | None, plot: Path | None, watch: int | None, record: Path | None
    ) -> None:
        self._save, self._plot, self._record = save, plot, record
        if watch is not None:
            checks.integer("watch", watch, least=1)
        if plot is not None:
            check_format("plot", plot)
            check_writable("plot", plot)
        if save is not None:
            check_writable("save", save)
        self.shown = watch or (DEFAULT_SHOWN if record is not None else 0)
        """How many of the last episodes are played again."""
        with ExitStack() as opened:
            self._screen = None if watch is None else opened.enter_context(closing(open_window(config)))
            self._recorder = None if record is None else opened.enter_context(closing(VideoRecorder(config, record)))
            self._opened = opened.pop_all()

    def __enter__(self) -> "Outputs":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._opened.__exit__(kind, error, traceback)

    def keep(self, run: Run, optimum: Optimum | None = None) -> None:
        """Saves and plots a run, a finished or an interrupted one, beside its optimum, and says where.

        Raises:
            OSError: if a file cannot be written after all.
        """
        if self._save is not None:
            run.save(self._save)
            print_above(f"Saved the run to {self._save}")
        if self._plot is not None:
            save_plot(run, self._plot, optimum)
            print_above(f"Saved the plot to {self._plot}")

    def show(self, run: Run) -> None:
        """Plays the recorded episodes to videos and on the screen."""
        different = 0
        if self._recorder is not None:
            different = self._recorder.record(run)
            print_above(f"Saved {len(run.recordings)} videos to {self._record}")
        if self._screen is not None:
            print_above(f"Showing the last {len(run.recordings)} episodes")
            different = replay_all(self._screen, run)
        if different:
            print_above(
                f"{different} of them went another way than in training: the environment keeps more than its random"
            )

"""The book's experiments: the base class, and those that compute their figures once instead of averaging runs."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field

from qtab._utils import checks, html
from qtab._utils.progress import check_progress
from qtab.book.description import Description
from qtab.book.line import Line
from qtab.book.result import Draw, Result
from qtab.training.train_many import thread_count


@dataclass(frozen=True, kw_only=True, repr=False)
class Experiment(Description, ABC):
    """An experiment of the book that can be run."""

    @property
    @abstractmethod
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""

    @abstractmethod
    def run(
        self, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
    ) -> Result:
        """Runs the experiment; see :func:`qtab.book.run`."""

    def check_arguments(self, runs: int | None, seed: int, threads: int | None) -> tuple[int, int, int]:
        """Returns the number of runs of each setting, the first seed, and the number of threads.

        Raises:
            TypeError: for an argument of the wrong type.
            ValueError: for an argument out of range.
        """
        runs = self.runs if runs is None else checks.integer("runs", runs, least=1)
        return runs, checks.integer("seed", seed, least=0), thread_count(threads)

    def _repr_html_(self) -> str:
        """HTML for notebooks: the description of the experiment."""
        facts = {
            "run it": f"qtab.book.run({self.name!r})",
            "in the book": self.book,
            **({"not in the book": self.unspecified} if self.unspecified else {}),
            "lines": "; ".join(self.line_names),
            "runs": f"{self.runs:,} of each setting",
            "axes": f"{self.y_label} by {self.x_label}",
        }
        return html.sentences(self.heading, (), list(facts.items()))


@dataclass(frozen=True, kw_only=True, repr=False)
class ComputedExperiment(Experiment):
    """An experiment whose lines are computed once: the number of runs has no effect."""

    draw: Draw = field(repr=False)
    """Draws the figure."""
    names: Sequence[str]
    """The names of the lines."""
    text: Callable[[Sequence[Line]], str] | None = None
    """Returns the table as text; None lists the points of the lines."""
    runs: int = 1

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        return self.names

    @abstractmethod
    def lines(self, seed: int) -> Sequence[Line]:
        """Computes the lines."""

    def run(
        self, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
    ) -> Result:
        """Computes the lines; see :func:`qtab.book.run`."""
        _, seed, _ = self.check_arguments(runs, seed, threads)
        check_progress(progress)
        started = time.perf_counter()
        lines = tuple(self.lines(seed))
        text = "" if self.text is None else self.text(lines)
        return Result(self, lines, 1, seed, time.perf_counter() - started, self.draw, table=text)


@dataclass(frozen=True, kw_only=True, repr=False)
class ExactExperiment(ComputedExperiment):
    """An experiment without random numbers: the seed has no effect either."""

    compute: Callable[[], Sequence[Line]]
    """Returns the lines."""

    def lines(self, seed: int) -> Sequence[Line]:  # noqa: ARG002
        """Computes the lines."""
        return self.compute()

    def conditions(self, counts: Collection[int], runs: int, seed: int) -> str:  # noqa: ARG002
        """Describes in words how a result was computed."""
        return "computed, without random numbers"

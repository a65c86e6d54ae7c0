"""The book's experiments: the base class, and those that compute their figures once instead of averaging runs."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from qtab._utils import checks, html
from qtab._utils.progress import check_progress
from qtab.book.description import Description
from qtab.book.drawing import draw_lines
from qtab.book.line import Line
from qtab.book.result import Draw, Result
from qtab.book.runner import FloatArray
from qtab.training.train_many import thread_count


class Outcome(NamedTuple):
    """The parts of a result that an experiment computes."""

    lines: Sequence[Line]
    surfaces: Mapping[str, FloatArray] = {}
    """The surfaces of the figure by title, if it has any."""
    table: str = ""
    """The table as text; empty if it is made from the points of the lines."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Experiment(Description, ABC):
    """An experiment of the book that can be run."""

    draw: Draw = field(default=draw_lines, repr=False)
    """Draws the figure."""
    names: Sequence[str] = ()
    """The names of the lines, if they do not follow from other fields."""

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        return self.names

    def run(
        self, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
    ) -> Result:
        """Runs the experiment; see :func:`qtab.book.run`."""
        runs, seed, threads = self.check_arguments(runs, seed, threads)
        check_progress(progress)
        started = time.perf_counter()
        lines, surfaces, table = self._run(runs, seed, threads, progress)
        seconds = time.perf_counter() - started
        return Result(self, tuple(lines), runs, seed, seconds, self.draw, surfaces, table)

    @abstractmethod
    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:
        """Computes the lines."""

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

    names: Sequence[str]
    """The names of the lines."""
    text: Callable[[Sequence[Line]], str] | None = None
    """Returns the table as text; None lists the points of the lines."""
    runs: int = 1

    @abstractmethod
    def lines(self, seed: int) -> Sequence[Line]:
        """Computes the lines."""

    def check_arguments(self, runs: int | None, seed: int, threads: int | None) -> tuple[int, int, int]:
        """Checks the arguments; the number of runs is always 1."""
        return 1, *super().check_arguments(runs, seed, threads)[1:]

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:  # noqa: ARG002
        lines = self.lines(seed)
        return Outcome(lines, table="" if self.text is None else self.text(lines))


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

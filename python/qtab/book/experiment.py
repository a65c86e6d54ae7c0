"""The base class of the book's experiments, which have a description and run many times to give a result."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from qtab._utils import checks, html
from qtab.book.description import Description
from qtab.book.result import Result
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

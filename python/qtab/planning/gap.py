"""``qtab.Gap``: the shortfall of a run from the optimum."""

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from qtab._utils import html
from qtab._utils.fields import with_fields
from qtab._utils.shown import counted

Number = TypeVar("Number", float, NDArray[np.float64])
"""A float for one run, (runs,) float64 for several."""


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class Gap(Generic[Number]):
    """The expected return of the optimum, the returns of a run, and their shortfalls."""

    optimum: float
    """The expected return of the optimum."""
    final_return: Number
    """The mean return of the run's last 100 training episodes, which include exploration."""
    greedy_return: Number
    """The expected return of the run's greedy policy under the time limit; NaN if its Q tables were not kept."""
    standard_error: Number
    """The standard error of ``greedy_return``; 0 if that was computed exactly, from a transition table."""
    label: str = "optimum"
    """``"optimum"``, or ``"best known"`` if the optimum is not proven."""
    attainable: float | None = None
    """The return of the best policy known with the run's table, whose cells join states, or which does not include the
    steps taken; None if it is not known. A lower bound: a better policy may exist."""

    @property
    def final(self) -> Number:
        """The optimum minus ``final_return``."""
        return self.optimum - self.final_return

    @property
    def greedy(self) -> Number:
        """The optimum minus ``greedy_return``."""
        return self.optimum - self.greedy_return

    @property
    def approximation(self) -> float | None:
        """The optimum minus ``attainable``: an upper bound on the part of the gap due to the table, not to learning."""
        return None if self.attainable is None else self.optimum - self.attainable

    @property
    def learning(self) -> Number | None:
        """``attainable`` minus ``greedy_return``: a lower bound on the part of the gap due to learning."""
        return None if self.attainable is None else self.attainable - self.greedy_return

    def __repr__(self) -> str:
        """A one-line summary; for several runs, with their means."""
        count = f" of {counted(np.size(self.final_return), 'run')}" if np.ndim(self.final_return) else ""
        return f"<Gap{count}: {self}>"

    def _repr_html_(self) -> str:
        """A table of the returns and the gaps, for notebooks."""
        heading = f"Gap of {counted(np.size(self.final_return), 'run')}" if np.ndim(self.final_return) else "Gap"
        rows = [
            ("greedy policy", *map(_shown, (self.greedy_return, self.greedy))),
            ("last 100 episodes of training", *map(_shown, (self.final_return, self.final))),
            (self.label, f"{self.optimum:.4g}", ""),
        ]
        attainable = self.attainable
        if attainable is not None and self._table_costs:
            rows.append(("best known with this table", _shown(attainable), _shown(self.optimum - attainable)))
        return html.listing(heading, ("", "return", "gap"), rows)

    def __str__(self) -> str:
        greedy_return, standard_error, gap = (
            float(np.mean(value)) for value in (self.greedy_return, self.standard_error, self.greedy)
        )
        uncertainty = f" ± {standard_error:.2g}" if standard_error > 0 else ""
        text = f"greedy policy {greedy_return:.4g}{uncertainty}, {self.label} {self.optimum:.4g}, gap {gap:.2g}"
        attainable = self.attainable
        if attainable is None or not self._table_costs:
            return text
        table = f"{self.optimum - attainable:.2g} due to the table, whose best known policy returns {attainable:.4g}"
        return f"{text}: {table}, and {attainable - greedy_return:.2g} due to learning"

    @property
    def _table_costs(self) -> bool:
        return self.attainable is not None and not np.isclose(self.attainable, self.optimum, rtol=1e-9, atol=1e-12)


def _shown(value: float | NDArray[np.float64]) -> str:
    """A number; for several runs, the mean and the range."""
    mean = f"{float(np.mean(value)):.4g}" if np.size(value) else "-"
    return f"{mean} ({np.min(value):.4g} to {np.max(value):.4g})" if np.size(value) > 1 else mean

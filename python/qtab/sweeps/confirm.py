"""Settings of a sweep, trained again with other seeds."""

from collections import Counter
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab._utils import checks, html
from qtab._utils.shown import shown
from qtab.sweeps.run_versions import versions_note
from qtab.sweeps.study import to_cell
from qtab.training.train_many import seed_numbers

if TYPE_CHECKING:
    from qtab.stats import Interval
    from qtab.sweeps.results import Sweep

MAX_SEEDS = 10**7
"""The maximum number of seeds of a confirmation."""


@dataclass(frozen=True, eq=False, repr=False)
class Confirmation:
    """Settings of a sweep, trained again with seeds that the sweep did not use."""

    chosen: tuple[int, ...]
    """The indices of the settings in the sweep, best first unless given by the user."""
    swept: "Sweep"
    """The sweep, whose means of the chosen settings are too high on average."""
    confirmed: "Sweep"
    """The results with the other seeds; its setting ``i`` is the setting ``chosen[i]`` of the sweep."""

    def mean(self, place: int = 0) -> "Interval":
        """Returns the mean final return of a chosen setting over the other seeds, without failed runs.

        Raises:
            ModuleNotFoundError: without SciPy; the message names the ``pip install``.
            TypeError: if ``place`` is not an integer.
            ValueError: if ``place`` is not an index of ``chosen``, or all runs of the setting failed.
        """
        from qtab import stats

        place = checks.integer("place", place, least=0, most=len(self.chosen) - 1)
        values = self.confirmed.values("final_return", place)
        if not len(values):
            raise ValueError(f"setting {self.chosen[place]} must have a run that succeeded, but all of them failed")
        return stats.mean(values)

    def __repr__(self) -> str:
        return f"<Confirmation of {len(self.chosen)} of {len(self.swept.settings)} settings: {self.confirmed!r}>"

    def _repr_html_(self) -> str:
        """Returns a table of the chosen settings with their means over the other seeds, for notebooks."""
        names = list(self.swept.settings[0]) if self.swept.settings else []
        swept = self.swept.mean_final_returns()
        rows = [
            (
                setting,
                *(self.swept.settings[setting][name] for name in names),
                f"{swept[setting]:.6g}",
                self._mean(place),
            )
            for place, setting in enumerate(self.chosen)
        ]
        heading = f"Confirmation of {len(self.chosen)} of {len(self.swept.settings)} settings of {self.swept.env}"
        note, columns = self._versions_note(), ("setting", *names, "mean in the sweep", "mean over the other seeds")
        return html.listing(heading, columns, rows, notes=[note] if note else [])

    def _mean(self, place: int) -> str:
        """Returns the mean with its interval, which is left out without SciPy or with a single run."""
        values = self.confirmed.values("final_return", place)
        with suppress(ModuleNotFoundError, ValueError):
            return str(self.mean(place))
        return f"{values.mean():.6g}" if len(values) else "no mean"

    def __str__(self) -> str:
        lines = [self._line(place, setting) for place, setting in enumerate(self.chosen)]
        note = self._versions_note()
        return "\n".join([*lines, note] if note else lines)

    def _versions_note(self) -> str:
        """Returns the differences between the versions that trained the sweep and the confirmation."""
        return versions_note([*self.swept.run_versions, *self.confirmed.run_versions])

    def _line(self, place: int, setting: int) -> str:
        values = ", ".join(f"{name} {value}" for name, value in self.swept.settings[setting].items())
        runs = self.confirmed.rows(place)
        found = len(self.confirmed.values("final_return", place))
        swept, failed = self.swept.mean_final_returns()[setting], len(runs) - found
        over = f"over {len(runs)} other seeds" + (f", {failed} failed" if failed else "")
        return f"setting {setting} ({values}): {self._mean(place)} {over}; {swept:.6g} in the sweep"


def chosen_settings(sweep: "Sweep", top: int, per: str | None, settings: Any) -> list[int]:
    """Returns the indices of the settings to train again; see :meth:`Sweep.confirm`.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    if settings is not None:
        if top != 1 or per is not None:
            raise ValueError("settings must be given without top and per, which choose settings")
        return _given(settings, len(sweep.settings))
    ranking = sweep.ranking()
    if not ranking:
        raise ValueError("a sweep without finished runs has no best setting")
    top = checks.integer("top", top, least=1, most=len(ranking))
    if per is None:
        return ranking[:top]
    per = checks.choice("per", per, list(sweep.settings[0]))
    found: Counter[Any] = Counter()
    chosen = []
    for index in ranking:
        value = to_cell(sweep.settings[index][per])
        found[value] += 1
        if found[value] <= top:
            chosen.append(index)
    return chosen


def _given(settings: Any, count: int) -> list[int]:
    if isinstance(settings, str | bytes) or not isinstance(settings, Iterable):
        raise TypeError(f"settings must be a sequence of indices of settings, got {shown(settings)}")
    indices = [checks.integer("settings", index, least=0, most=count - 1) for index in settings]
    if not indices or len(set(indices)) < len(indices):
        raise ValueError(f"settings must hold different indices, at least one, got {shown(indices)}")
    return indices


def other_seeds(sweep: "Sweep", seeds: Any) -> tuple[int, ...]:
    """Returns the seeds of a confirmation.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for seeds that the sweep used, or an argument out of range.
    """
    if hasattr(seeds, "__index__") and not np.ndim(seeds):
        first = max(sweep.seeds) + 1
        return seed_numbers(range(first, first + checks.integer("seeds", seeds, least=1, most=MAX_SEEDS)))
    numbers = seed_numbers(seeds)
    used = sorted(set(numbers) & set(sweep.seeds))
    if used:
        raise ValueError(f"seeds must be other seeds than those of the sweep, got {used[0]}, which it used")
    return numbers

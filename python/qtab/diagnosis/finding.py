"""The result of a check: the evidence, its meaning, the advice, and the changes that it advises."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from qtab._utils import html
from qtab.config import DEFAULTS, Config
from qtab.config.options import OPTIONS, is_set
from qtab.config.validation import mismatch

COLUMNS = ("finding", "evidence", "change")
"""The columns of a table of findings."""


class Share(float):
    """A share of a whole, from 0 to 1, which is shown in percent."""


@dataclass(frozen=True)
class Unchecked:
    """A check that could not be made, which is not the same as one that found nothing."""

    reason: str
    """The reason, to follow the word "as"."""


@dataclass(frozen=True, repr=False)
class Finding:
    """A likely reason why a run did not solve its environment."""

    name: str = field(default="", kw_only=True)
    """The name of the check, which :func:`qtab.diagnose` sets."""
    title: str
    """The finding in one sentence."""
    evidence: Mapping[str, float]
    """The numbers behind the finding, each by its name."""
    meaning: str
    """The meaning of the numbers for learning."""
    advice: str
    """The advised change, in words."""
    changes: tuple[Mapping[str, Any], ...] = field(default=())
    """Settings to try, each as keyword arguments of :func:`qtab.train`; :meth:`qtab.Diagnosis.what_if` tries them."""

    def __repr__(self) -> str:
        """Returns one line; ``print`` shows the whole finding."""
        return f"<Finding {self.name!r}: {self.title}>"

    def cells(self) -> tuple[str, str, str]:
        """Returns the finding in the columns of a table: see ``COLUMNS``."""
        evidence = "\n".join(f"{name}: {number_text(value)}" for name, value in self.evidence.items())
        return f"{self.title}\n{self.meaning}", evidence, self.advice

    def _repr_html_(self) -> str:
        """HTML for notebooks: a table of one row."""
        return html.sentences(f"Finding {self.name!r}", COLUMNS, [self.cells()])

    def __str__(self) -> str:
        """Returns a few lines: the title, the evidence, the meaning and the advice."""
        evidence = "; ".join(f"{name}: {number_text(value)}" for name, value in self.evidence.items())
        return f"{self.title}\n  evidence  {evidence}\n  meaning   {self.meaning}\n  change    {self.advice}"


def number_text(value: float) -> str:
    """Returns a number with four digits, an integer in full, a :class:`Share` in percent."""
    if isinstance(value, Share):
        return percent(value)
    return f"{value:,}" if isinstance(value, int) else f"{value:.4g}"


def percent(share: float) -> str:
    """Returns a share in percent."""
    return f"{100 * share:.3g} %"


def as_keywords(change: Mapping[str, Any]) -> str:
    """Returns a change as keyword arguments."""
    return ", ".join(f"{name}={value!r}" for name, value in change.items())


_LOWEST = {"min_epsilon": "epsilon", "min_learning_rate": "learning_rate"}
"""The lower limits of rates that fall."""
_OF_SHAPES = {"discretizer", *(name for name, option in OPTIONS.items() if option.choice == "discretizer")} - {
    *("low", "high")
}
"""The settings on which the shape of a table depends."""


def change(config: Config, **settings: Any) -> Mapping[str, Any] | None:
    """Returns settings to try, completed by those that have to change with them, or None if the config refuses them.

    Options that no longer apply are reset, and the lower limit of a rate stays the same fraction of it.

    Args:
        config: The config of a run.
        **settings: The settings to change, as keyword arguments of :func:`qtab.train`.
    """
    given = dict(settings)
    fields = {**vars(config), **given}
    for lowest, rate in _LOWEST.items():
        least, before, after = fields[lowest], getattr(config, rate), fields[rate]
        if lowest not in settings and least and before and after is not None and after < before:
            given[lowest] = fields[lowest] = least * after / before
    for name in (*OPTIONS, "terminal_update"):
        if name not in settings and is_set(fields[name]) and mismatch(name, fields[name], fields):
            given[name] = fields[name] = DEFAULTS[name]
    if isinstance(config.initial_q, np.ndarray) and not given.keys().isdisjoint(_OF_SHAPES):
        return None  # the initial table would no longer fit
    try:
        changed = config.replace(**given)
    except (TypeError, ValueError):
        return None
    return None if changed == config else given


def changes(config: Config, *candidates: Mapping[str, Any]) -> tuple[Mapping[str, Any], ...]:
    """Returns the candidates that the config of a run accepts, completed as by :func:`change`."""
    return given(change(config, **settings) for settings in candidates)


def given(candidates: Iterable[Mapping[str, Any] | None]) -> tuple[Mapping[str, Any], ...]:
    """Returns the candidates that are not None."""
    return tuple(candidate for candidate in candidates if candidate is not None)

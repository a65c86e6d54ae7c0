"""The result of a check: the evidence, its meaning, and the advice."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from qtab._utils import html

COLUMNS = ("finding", "evidence", "change")
"""The columns of a table of findings."""


@dataclass(frozen=True)
class Unchecked:
    """A check that could not be made, which is not the same as one that found nothing."""

    reason: str
    """The reason, to follow the word "as"."""


@dataclass(frozen=True, repr=False)
class Finding:
    """A likely reason why a run did not solve its environment."""

    name: str
    """The name of the check."""
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
        evidence = ", ".join(f"{name} {number_text(value)}" for name, value in self.evidence.items())
        return f"{self.title}\n  evidence  {evidence}\n  meaning   {self.meaning}\n  change    {self.advice}"


def number_text(value: float) -> str:
    """Returns a number with four digits, an integer in full."""
    return f"{value:,}" if isinstance(value, int) else f"{value:.4g}"


def percent(share: float) -> str:
    """Returns a share in percent."""
    return f"{100 * share:.3g} %"


def as_keywords(change: Mapping[str, Any]) -> str:
    """Returns a change as keyword arguments."""
    return ", ".join(f"{name}={value!r}" for name, value in change.items())

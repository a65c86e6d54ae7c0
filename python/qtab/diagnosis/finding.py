"""What a check returns: the evidence, what it means, and what to change."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Finding:
    """A likely reason why a run did not solve its environment."""

    name: str
    """The name of the check."""
    title: str
    """The finding in one sentence."""
    evidence: Mapping[str, float]
    """The numbers behind it, by what they are."""
    meaning: str
    """What the numbers mean for learning."""
    advice: str
    """What to change."""
    changes: tuple[Mapping[str, Any], ...] = field(default=())
    """Settings to try, each as keyword arguments of :func:`qtab.train`; :meth:`qtab.Diagnosis.what_if` tries them."""

    def __str__(self) -> str:
        """A few lines: the title, the evidence, the meaning and the advice."""
        evidence = ", ".join(f"{name} {shown(value)}" for name, value in self.evidence.items())
        return f"{self.title}\n  evidence  {evidence}\n  meaning   {self.meaning}\n  change    {self.advice}"


def shown(value: float) -> str:
    """Returns a number with four digits, an integer in full."""
    return f"{value:,}" if isinstance(value, int) else f"{value:.4g}"


def percent(share: float) -> str:
    """Returns a share in percent."""
    return f"{100 * share:.3g} %"


def as_keywords(change: Mapping[str, Any]) -> str:
    """Returns a change as keyword arguments."""
    return ", ".join(f"{name}={value!r}" for name, value in change.items())

"""How a call uses the environment that it resolves."""

from dataclasses import dataclass
from typing import Any

TYPICAL_MAX_STEPS = 1_000
"""The expected maximum number of steps of an episode whose time limit is longer."""


@dataclass(frozen=True)
class Use:
    """How a call that may compile an ordinary class by default uses the environment."""

    runs: int = 1
    """The number of runs with these settings; for more of them, a compilation is more worthwhile."""
    watched: str | None = None
    """Why code of the user may see or change the environment during the training; None if none can."""
    maker: Any = None
    """The class or the function that makes an environment for each of several runs; None for a single run."""
    resumes: bool = False
    """Whether a run is resumed that was compiled by default: Python steps the class if it cannot be compiled here."""

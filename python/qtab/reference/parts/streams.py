"""The agent's random numbers, from NumPy."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray


class AgentStream(Protocol):
    """The random numbers that a learner draws."""

    def random(self) -> float:
        """Returns a float in [0, 1)."""

    def integers(self, low: int, high: int) -> int:
        """Returns an integer from ``low`` to ``high`` - 1."""

    def uniform(self, low: float, high: float, size: tuple[int, ...]) -> NDArray[np.float64]:
        """Returns floats in [``low``, ``high``), in C order."""


class LegacyStream(np.random.RandomState):
    """NumPy's legacy generator: the numbers after ``np.random.seed(seed)``, without touching NumPy's global state."""

    def integers(self, low: int, high: int) -> int:
        """Returns an integer from ``low`` to ``high`` - 1."""
        return int(self.randint(low, high))


def agent_stream(seed: int, bit_generator: str) -> AgentStream:
    """Returns the agent's random generator for a seed."""
    if bit_generator == "MT19937":
        return LegacyStream(seed)
    child = np.random.SeedSequence(seed).spawn(1)[0]
    generator: AgentStream = np.random.default_rng(child)
    return generator

"""Linear function approximation: exact quantities from a transition table, and least-squares TD."""

from qtab.prediction.linear.expected_updates import expected_updates
from qtab.prediction.linear.from_table import linear_geometry
from qtab.prediction.linear.geometry import LinearGeometry
from qtab.prediction.linear.lstd import LSTD

__all__ = ["LSTD", "LinearGeometry", "expected_updates", "linear_geometry"]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]

"""Exact quantities of linear function approximation, from a transition table and a feature matrix."""

from qtab.prediction.linear.expected_updates import expected_updates
from qtab.prediction.linear.from_table import linear_geometry
from qtab.prediction.linear.geometry import LinearGeometry

__all__ = ["LinearGeometry", "expected_updates", "linear_geometry"]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]

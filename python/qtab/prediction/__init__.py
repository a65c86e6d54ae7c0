"""Prediction: the values of a given policy, estimated from episodes."""

from qtab.prediction.estimate import estimate_values
from qtab.prediction.estimates import ValueEstimates
from qtab.prediction.features import state_aggregation, tile_coding
from qtab.prediction.linear import LSTD, LinearGeometry, expected_updates, linear_geometry
from qtab.prediction.settings import METHODS, PredictionSettings

__all__ = [
    "LSTD",
    "METHODS",
    "LinearGeometry",
    "PredictionSettings",
    "ValueEstimates",
    "estimate_values",
    "expected_updates",
    "linear_geometry",
    "state_aggregation",
    "tile_coding",
]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]

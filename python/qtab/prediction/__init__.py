"""Prediction: the values of a given policy, estimated from episodes."""

from qtab.prediction.estimate import estimate_values
from qtab.prediction.estimates import ValueEstimates
from qtab.prediction.features import state_aggregation, tile_coding
from qtab.prediction.settings import METHODS, PredictionSettings

__all__ = [
    "METHODS",
    "PredictionSettings",
    "ValueEstimates",
    "estimate_values",
    "state_aggregation",
    "tile_coding",
]

"""The features of the states of a prediction, and the initial weights, from the arguments."""

from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils.arrays import numbers
from qtab._utils.shown import shown
from qtab.discretizers import Discretizer
from qtab.discretizers.weighted.polynomial import OF_FUNCTION
from qtab.planning.least_squares.lstdq import GivenFeatures
from qtab.prediction.features import (
    Rows,
    Vectors,
    are_floats,
    feature_rows,
    feature_vectors,
    features_of_function,
)
from qtab.prediction.learning_rates import AVERAGES_ONLY, LEAST_SQUARES, rate_settings
from qtab.prediction.settings import PredictionSettings

MOST_RECURSIVE, MOST_SOLVED = 4096, 1024
"""The largest numbers of weights of LSTD, if it updates a matrix at each step, and if it solves equations."""


@dataclass(frozen=True, eq=False)
class StateFeatures:
    """The features of the states."""

    rows: Rows | None
    """The active rows of each cell; None for feature vectors, or if the observations have features of their own."""
    vectors: Vectors | None
    """The feature vector of each cell; None for active rows, or if the observations have features of their own."""
    n_weights: int
    """The number of weights."""
    n_active: int
    """The number of weights that add up to a value."""
    is_weighted: bool
    """Whether the features have values other than 1."""

    @property
    def nbytes(self) -> int:
        """The memory of the features of the cells."""
        return sum(0 if array is None else array.nbytes for array in (self.rows, self.vectors))


def state_features(
    features: GivenFeatures | None, cells: Discretizer, space: gym.Space[Any] | None, settings: PredictionSettings
) -> StateFeatures:
    """Returns the features of the states of a prediction.

    Args:
        features: The argument of :func:`qtab.estimate_values`.
        cells: The discretizer of the observations.
        space: The observation space, needed only for a function.
        settings: The settings of the prediction.

    Raises:
        TypeError: if ``features`` are not numbers.
        ValueError: for another shape, or if the features do not fit the discretizer, the method or its learning rate.
    """
    found = _of_cells(features, cells, space) if cells.has_cells else _of_observations(features, cells)
    method = settings.method
    if found.is_weighted:
        _check_weighted(settings, "features" if cells.has_cells else "discretizer", cells)
    if method in AVERAGES_ONLY and (found.n_active > 1 or not cells.has_cells):
        if cells.has_cells:
            raise ValueError(f"features must have one active row for method {method!r}, got {found.n_active}")
        raise ValueError(
            f"discretizer must be 'round', 'bins' or 'edges' for method {method!r}, which averages in each cell, got "
            f"{_name(cells)}"
        )
    if settings.first_visit and not cells.has_cells:
        raise ValueError(
            f"first_visit must be False for discretizer {_name(cells)}, where no state is visited twice, got True"
        )
    most = MOST_RECURSIVE if settings.recursive else MOST_SOLVED
    if method == LEAST_SQUARES and found.n_weights > most:
        name = "discretizer" if features is None else "features"
        kind = f"{method!r} with recursive={settings.recursive}"
        raise ValueError(f"{name} must give at most {most:,} weights for method {kind}, got {found.n_weights:,}")
    rate = settings.learning_rate
    if found.n_active == 1 and not found.is_weighted and rate is not None and rate > 1.0:
        raise ValueError(f"learning_rate must lie in [0, 1] for a table, got {shown(rate)}")
    return found


def initial_weights(
    given: ArrayLike | None, features: StateFeatures, settings: PredictionSettings
) -> NDArray[np.float64]:
    """Returns the weights before the first episode, (n_weights,).

    Raises:
        TypeError: if the given weights are not numbers.
        ValueError: for another number of weights, or if they do not go with the initial value, the features or the
            method.
    """
    value, method = settings.initial_value, settings.method
    if given is None:
        if features.is_weighted and value != 0.0:
            raise ValueError(
                "initial_value must be 0 for features with values other than 1; initial_weights= sets each weight, got "
                f"{shown(value)}"
            )
        # Some references add 0 to the weights that do not change, which turns -0.0 into 0.0.
        return np.full(features.n_weights, value / features.n_active) + 0.0
    if method == LEAST_SQUARES:
        raise ValueError(f"initial_weights must be None for method {method!r}, whose weights follow from the steps")
    if value != 0.0:
        raise ValueError(f"initial_value must be 0 with initial_weights, got {shown(value)}")
    weights = numbers("initial_weights", given)
    if weights.shape != (features.n_weights,):
        raise ValueError(f"initial_weights must have the shape ({features.n_weights},), got {weights.shape}")
    return np.ascontiguousarray(weights) + 0.0


def _of_cells(features: GivenFeatures | None, cells: Discretizer, space: gym.Space[Any] | None) -> StateFeatures:
    if callable(features):
        features = features_of_function(features, cells, space)
    if features is not None and are_floats(features) and np.ndim(features) > 1:
        vectors = feature_vectors(features, cells.n_rows, cells.shape)
        count = vectors.shape[1]
        return StateFeatures(None, vectors, count, count, is_weighted=True)
    rows, n_weights = feature_rows(features, cells.n_rows)
    return StateFeatures(rows, None, n_weights, rows.shape[1], is_weighted=False)


def _of_observations(features: GivenFeatures | None, cells: Discretizer) -> StateFeatures:
    if features is not None:
        whose = "which gives the features" if cells.is_weighted else "whose tiles are the features"
        instead = f"; {OF_FUNCTION}" if callable(features) else ""
        raise ValueError(
            f"features must be None for discretizer {_name(cells)}, {whose}, got {shown(features)}{instead}"
        )
    return StateFeatures(None, None, cells.n_rows, cells.n_active, is_weighted=cells.is_weighted)


def _check_weighted(settings: PredictionSettings, name: str, cells: Discretizer) -> None:
    """Rejects the methods and learning rates that have no meaning for features with values other than 1."""
    given = "an array of floats" if cells.has_cells else _name(cells)
    method = settings.method
    if method in AVERAGES_ONLY:
        fit = "None or an array of integers" if cells.has_cells else "'round', 'bins' or 'edges'"
        raise ValueError(f"{name} must be {fit} for method {method!r}, which averages in each cell, got {given}")
    if rate_settings(vars(settings))["learning_rate_schedule"] == "visits":
        if settings.learning_rate is None:
            raise ValueError(
                "learning_rate must be given for features with values other than 1, because their visits are not "
                "counted, got None"
            )
        raise ValueError(
            "learning_rate_schedule must be 'constant', 'linear' or 'exponential' for features with values other than "
            "1, got 'visits'"
        )
    if method == LEAST_SQUARES and getattr(cells, "scale_step_sizes", False):
        raise ValueError(f"scale_step_sizes must be False for method {method!r}, which has no step size, got True")


def _name(cells: Discretizer) -> str:
    """Returns the name of a discretizer without cells, as the user wrote it."""
    name: Any = cells.spec()["type"]
    return repr(name)

"""Feature matrices: a vector of real numbers for each state."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab.prediction.features import are_floats, feature_rows, feature_vectors


def feature_matrix(
    features: ArrayLike | None, states: int, shape: tuple[int, ...] | None = None
) -> NDArray[np.float64]:
    """Returns the matrix X, (states, d) float64, whose rows are the feature vectors x(s) (Sutton & Barto, section 9.4).

    Args:
        features: (states, d) floats: the feature vector of each state; or, as in :func:`qtab.estimate_values`, None for
            a table or (states,) or (states, n_active) integers: the features that are active in each state.
        states: The number of states.
        shape: The shape of the states, which may replace the first axis of the feature vectors; None means one axis.

    Raises:
        TypeError: if the features are not numbers.
        ValueError: for another shape, or a number that is not finite.
    """
    if features is None or not are_floats(features):
        rows, count = feature_rows(features, states)
        matrix = np.zeros((states, count))
        # A feature that is listed twice counts twice, as in the sum of the weights.
        np.add.at(matrix, (np.arange(states)[:, None], rows), 1.0)
        return matrix
    return feature_vectors(features, states, shape)

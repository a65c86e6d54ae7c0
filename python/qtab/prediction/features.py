"""The features of state values: a table, groups of states, tilings of numbered states, given rows or given vectors."""

from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab._utils.arrays import numbers
from qtab._utils.memory import check_memory
from qtab._utils.shown import counted, shown
from qtab.discretizers import Discretizer
from qtab.discretizers.weighted.polynomial import OF_FUNCTION
from qtab.planning.least_squares.lstdq import check_vectors
from qtab.planning.policies import discrete_observations

Rows = NDArray[np.uint32]
"""(states, n_active): the active rows of each state."""
Vectors = NDArray[np.float64]
"""(states, d): the feature vector of each state."""


def state_aggregation(states: int, size: int) -> Rows:
    """Returns the features of groups of consecutive states, which share a value (Sutton & Barto, section 9.3).

    Args:
        states: The number of states.
        size: The number of states in a group; the last group may be smaller.

    Returns:
        The group of each state, (states, 1) uint32.

    Raises:
        TypeError: for an argument that is not an integer.
        ValueError: for an argument below 1.
    """
    states, size = checks.count("states", states, least=1), checks.count("size", size, least=1)
    return (np.arange(states, dtype=np.uint32) // size)[:, None]


def tile_coding(states: int, width: int, tilings: int = 1, offset: int = 0) -> Rows:
    """Returns the features of several tilings of numbered states (Sutton & Barto, Figure 9.10).

    Tiling t is shifted by t * ``offset`` states to the left.

    Args:
        states: The number of states.
        width: The number of states of a tile.
        tilings: The number of tilings.
        offset: The number of states by which each tiling is shifted from the previous one.

    Returns:
        The tile of each state in each tiling, (states, tilings) uint32.

    Raises:
        TypeError: for an argument that is not an integer.
        ValueError: for an argument that is too small, or shifts of more than a tile in all.
    """
    states, width = checks.count("states", states, least=1), checks.count("width", width, least=1)
    tilings, offset = checks.count("tilings", tilings, least=1), checks.count("offset", offset, least=0)
    if (tilings - 1) * offset >= width:
        raise ValueError(f"offset must shift the {tilings} tilings by less than the width {width} in all, got {offset}")
    shift = np.arange(tilings) * offset
    tiles = -(-(states + int(shift[-1])) // width)
    numbers = (np.arange(states)[:, None] + shift) // width + np.arange(tilings) * tiles
    return numbers.astype(np.uint32)


def feature_rows(features: ArrayLike | None, states: int) -> tuple[Rows, int]:
    """Returns the active rows of each state, and the number of weights.

    Args:
        features: None for a table; or (states,) or (states, n_active) integers from 0.
        states: The number of states.

    Raises:
        TypeError: if the features are not integers.
        ValueError: for another shape, or a number that is negative or too large.
    """
    if features is None:
        return np.arange(states, dtype=np.uint32)[:, None], states
    try:
        given: NDArray[Any] = np.asarray(features)
    except ValueError:  # rows of different lengths
        given = np.asarray(None)
    too_large = given.dtype.kind == "O" and all(type(number) is int for number in given.flat)  # for 64 bits
    if given.dtype.kind not in "iu" and not too_large:
        raise TypeError(
            "features must be None or an array of integers, or of floats with a vector for each state, got "
            f"{shown(features)}"
        )
    if given.ndim not in (1, 2) or len(given) != states or given.size == 0:
        raise ValueError(f"features must have a row of numbers for each of the {states} states, got {given.shape}")
    least, most = int(given.min()), int(given.max())
    if least < 0 or most >= 2**31:
        raise ValueError(f"features must hold numbers from 0 to {2**31 - 1}, got {least if least < 0 else most}")
    rows = np.ascontiguousarray(given.reshape(states, -1).astype(np.uint32))
    return rows, int(rows.max()) + 1


def feature_vectors(features: ArrayLike, states: int, shape: tuple[int, ...] | None = None) -> Vectors:
    """Returns the feature vector of each state.

    Args:
        features: (states, d) floats.
        states: The number of states.
        shape: The shape of the states, which may replace the first axis of the feature vectors; None means one axis.

    Raises:
        TypeError: if the features are not numbers.
        ValueError: for another shape, or a number that is not finite.
    """
    given = numbers("features", features)
    if shape is not None and given.shape[:-1] == shape:
        given = given.reshape(states, -1)
    if given.ndim != 2 or len(given) != states or given.size == 0:
        raise ValueError(
            f"features must have a feature vector for each of the {counted(states, 'state')}, in an array of shape "
            f"({states}, d), got {given.shape}"
        )
    return np.ascontiguousarray(given)


def features_of_function(function: Callable[[Any], Any], cells: Discretizer, space: gym.Space[Any] | None) -> Vectors:
    """Returns the feature vector that a function returns for the observation of each state.

    Args:
        function: The function from an observation to (d,) numbers.
        cells: The discretizer of the observations.
        space: The observation space.

    Raises:
        TypeError: if the function does not return numbers, or returns the row numbers of a discretizer.
        ValueError: for another shape, a number that is not finite, or observations that are not discrete.
    """
    check_vectors(function)
    if not isinstance(space, gym.spaces.Discrete | gym.spaces.MultiDiscrete | gym.spaces.Tuple):
        raise ValueError(
            f"features must be an array for observations that are not discrete, got a function; {OF_FUNCTION}"
        )
    vectors: list[Vectors] = []
    for observation in discrete_observations(space, cells):
        where = f"for the observation {shown(np.asarray(observation).tolist())}"
        returned = function(observation)
        if returned is None:
            raise TypeError(f"features must return a vector of numbers, got None {where}")
        vector = numbers(f"features {where}", returned)
        if vector.ndim != 1 or not vector.size or (vectors and vector.shape != vectors[0].shape):
            wanted = counted(len(vectors[0]), "number") if vectors else "numbers"
            raise ValueError(f"features must return a vector of {wanted}, got the shape {vector.shape} {where}")
        vectors.append(vector)
    return np.stack(vectors)


def feature_matrix(features: ArrayLike | None, states: int, shape: tuple[int, ...] | None = None) -> Vectors:
    """Returns the matrix X, (states, d) float64, whose rows are the feature vectors x(s) (Sutton & Barto, section 9.4).

    Args:
        features: (states, d) floats: the feature vector of each state; or, as in :func:`qtab.estimate_values`, None for
            a table or (states,) or (states, n_active) integers: the features that are active in each state.
        states: The number of states.
        shape: The shape of the states, which may replace the first axis of the feature vectors; None means one axis.

    Raises:
        MemoryError: if the matrix would take more than half of the machine's memory, or more than is free.
        TypeError: if the features are not numbers.
        ValueError: for another shape, or a number that is not finite.
    """
    if features is None or not are_floats(features):
        rows, count = feature_rows(features, states)
        check_memory(f"a matrix of {states:,} x {count:,} numbers for {count:,} features", 8 * states * count)
        matrix = np.zeros((states, count))
        # A feature that is listed twice counts twice, as in the sum of the weights.
        np.add.at(matrix, (np.arange(states)[:, None], rows), 1.0)
        return matrix
    return feature_vectors(features, states, shape)


def are_floats(features: Any) -> bool:
    """Returns whether features are an array of floats."""
    try:
        return np.asarray(features).dtype.kind == "f"
    except ValueError:  # rows of different lengths
        return False

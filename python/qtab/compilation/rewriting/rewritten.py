"""The result of rewriting a class."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.compilation.not_compilable import NotCompilable


@dataclass(frozen=True, eq=False)
class Rewritten:
    """A Gymnasium class as plain functions over a record of its numbers.

    ``record`` is one element of a structured array of ``dtype``, and is changed in place; ``rng`` is a
    ``numpy.random.Generator``. An exception means that the class would have raised one too, except that an integer may
    have left its range, or an array may have changed its shape.
    """

    reset: Callable[..., Any]
    """``reset(record, rng) -> observation``"""
    step: Callable[..., Any]
    """``step(record, action, rng) -> (observation, reward, terminated, truncated)``.

    Actions count from ``action_space.start``, as in the class. Observations are numbers or arrays; those of Tuple and
    Dict spaces are tuples in the order of the space."""
    action_mask: Callable[..., Any] | None
    """``action_mask(record) -> array of booleans or numbers``, from ``action_masks()`` or the info dict; None without
    masks."""
    mask_refusal: NotCompilable | None
    """Why the action mask of the class cannot be compiled; None if it can, or if the class has none."""
    dtype: np.dtype[Any]
    """The record: the attributes that steps and resets use and change."""
    initial: NDArray[Any]
    """(1,): the record before the first reset."""
    kept_between_episodes: tuple[str, ...]
    """The attributes that change, and that ``reset`` does not assign before it reads them: the first state of an
    episode depends on the episodes before."""
    lines: dict[int, tuple[str, int]]
    """For each line of ``source`` the file and the line of the class."""
    source: str
    """The functions as a module, without imports except of NumPy and ``math``."""
    namespace: dict[str, Any] = field(repr=False)
    """The globals of the functions."""

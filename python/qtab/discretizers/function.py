"""A function as the discretizer, which maps an observation to the indices of its cell."""

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from qtab._spec import IdentitySpec
from qtab._utils.shown import shown
from qtab.config import Config
from qtab.config.functions import function_name
from qtab.discretizers.base import Discretizer, check_table_size
from qtab.discretizers.layout import Layout
from qtab.discretizers.weighted.polynomial import OF_FUNCTION


@dataclass(frozen=True, eq=False, repr=False)
class Function(Discretizer):
    """The user's function, which receives every observation, whatever the space."""

    reads_space = True
    has_component_axes = False

    function: Callable[[Any], Any]
    """Maps an observation to its indices within the shape, or to one integer, the number of its row."""
    cell_shape: tuple[int, ...] | None
    """The shape of the table without the axis of actions; None if rows are assigned to any integers."""
    observation_shape: tuple[int, ...] | None
    """The shape of an observation, used to recognize a batch; None if the space has no shape."""
    layout: Layout | None = None
    """The layout of a Dict or Tuple of numbers, used to recognize a batch; None for any other space."""

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "Function":
        """Returns the function of a config, over any observation space.

        Raises:
            ValueError: if the setting ``shape`` is missing, or the table would be too large.
        """
        if config.shape is None and config.max_rows is None:
            raise ValueError(
                "shape must be given for a function as the discretizer, the shape of the table that its indices lie "
                "in, such as (19, 15); or max_rows="
            )
        if config.shape is not None and n_actions:
            check_table_size("shape", config.shape, math.prod(map(float, config.shape)) * n_actions)
        layout = None
        if isinstance(space, spaces.Dict | spaces.Tuple):
            with suppress(ValueError):  # the space holds other things than numbers
                layout = Layout.of_space(space)
        return cls._of(config, space.shape, layout)

    @classmethod
    def _of(cls, config: Config, observation_shape: tuple[int, ...] | None, layout: Layout | None) -> "Function":
        shape: Any = config.shape
        low = np.zeros(len(shape or ()), np.int64)
        high = low if shape is None else np.array(shape, np.int64) - 1
        function: Any = config.discretizer
        return cls(low, high, function, shape, observation_shape, layout)

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "Function":
        """Returns the function that was given to ``qtab.load``; see :meth:`Discretizer.restore`."""
        if config.max_rows is None and (config.shape is None or math.prod(config.shape) != n_rows):
            raise ValueError("its table has another number of rows than its shape")
        stored = arrays.get("observation_shape")
        if stored is not None and (stored.dtype != np.int64 or stored.ndim != 1 or (stored < 0).any()):
            raise ValueError("its observations do not have a shape")
        layout = Layout.from_json(str(arrays["layout"])) if "layout" in arrays else None
        return cls._of(config, None if stored is None else tuple(stored.tolist()), layout)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Returns the arrays to save."""
        if self.layout is not None:
            return {"layout": np.array(self.layout.to_json())}
        if self.observation_shape is None:
            return {}
        return {"observation_shape": np.array(self.observation_shape, np.int64)}

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the table without the axis of actions."""
        return self.cell_shape or ()

    @property
    def component_names(self) -> tuple[str, ...]:
        """A name for each index."""
        name = function_name(self.function)
        return tuple(f"{name}[{index}]" for index in range(len(self.shape)))

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the midpoints between the indices."""
        return tuple(np.arange(count + 1.0) - 0.5 for count in self.shape)

    def spec(self) -> IdentitySpec:
        """Returns the spec for the extension, whose observations are row numbers."""
        return {"type": "identity", "first": [0], "counts": [self.n_rows], "scalar": True}

    def cells(self, observation: Any) -> tuple[int, ...]:
        """Calls the function for one observation; returns its indices within the shape, after checking them.

        Raises:
            TypeError: if the function does not return integers.
            ValueError: if the integers do not lie within the shape.
        """
        returned = self.function(observation)
        indices = _integers(returned)
        if indices is None:
            one_axis = self.cell_shape is not None and len(self.cell_shape) == 1
            wanted = self._wanted if one_axis else f"integers, {self._wanted}"
            instead = f"; {OF_FUNCTION}" if _have_fractions(returned) else ""
            raise TypeError(f"discretizer must return {wanted}, got {shown(returned)}{instead}")
        cell = tuple(int(index) for index in np.atleast_1d(indices))
        if self.cell_shape is None:
            if not all(-(2**63) <= index < 2**63 for index in cell):
                raise ValueError(f"discretizer must return integers from -2**63 to 2**63 - 1, got {shown(returned)}")
            return cell
        if not indices.ndim and len(self.cell_shape) > 1 and 0 <= cell[0] < self.n_rows:
            return tuple(int(index) for index in np.unravel_index(cell[0], self.cell_shape))
        within = len(cell) == len(self.cell_shape) and all(
            0 <= index < count for index, count in zip(cell, self.cell_shape, strict=True)
        )
        if not within:
            raise ValueError(f"discretizer must return {self._wanted}, got {shown(returned)}")
        return cell

    @property
    def _wanted(self) -> str:
        if self.cell_shape is None:
            return "one or several"
        if len(self.cell_shape) == 1:
            return f"an integer from 0 to {self.cell_shape[0] - 1}"
        return f"{len(self.cell_shape)} indices within the shape {self.cell_shape}, or the number of a row"

    def with_function(self, function: Callable[[Any], Any]) -> "Function":
        """Returns the discretizer with ``function``."""
        return replace(self, function=function)

    def observe(self, observation: Any) -> int:
        """Returns the row of an observation, as the extension reads it."""
        row = 0
        for index, count in zip(self.cells(observation), self.shape, strict=True):
            row = row * count + index
        return row

    def along_axes(self, observation: Any) -> NDArray[Any]:
        """Returns (d,): the indices that the function returns."""
        return np.array(self.cells(observation))

    def active_rows(self, observation: Any) -> NDArray[np.int64]:
        """Returns the (1,) row of an observation, or the (n, 1) rows of n observations.

        Observations are batched as in Gymnasium's vector environments. A space that holds other things than numbers has
        no batches.

        Raises:
            TypeError: if the function does not return integers.
            ValueError: if the integers do not lie within the shape.
        """
        return self.rows_by(self.observe, observation)

    def rows_by(self, row: Callable[[Any], int], observation: Any) -> NDArray[np.int64]:
        """Returns (1,) or (n, 1): the results of ``row`` for one or n observations."""
        count = self._batch_size(observation)
        if count is None:
            return np.array([row(observation)], np.int64)
        return np.array([row(one) for one in self.split(observation, count)], np.int64).reshape(-1, 1)

    def _batch_size(self, observation: Any) -> int | None:
        if self.layout is not None:
            try:
                return self.layout.batch_size(observation)
            except ValueError:  # the function may accept observations that the space does not describe
                return None
        if self.observation_shape is None:
            return None
        shape = np.shape(observation)
        return shape[0] if shape and shape[1:] == self.observation_shape else None

    def split(self, observation: Any, count: int | None) -> list[Any]:
        """Returns a list of ``count`` observations in the structure of the space; None means a single one."""
        return super().split(observation, count) if self.layout is None else self.layout.split(observation, count)


def _have_fractions(returned: Any) -> bool:
    """Returns whether the result of a function holds numbers with a fractional part."""
    try:
        found = np.asarray(returned)
    except ValueError:  # parts of different lengths
        return False
    return found.dtype.kind == "f" and bool(np.any(found != np.floor(found)))


def _integers(returned: Any) -> NDArray[Any] | None:
    """Returns the result of a function as an array of at most one axis; None unless it holds integers, of any size."""
    try:
        indices = np.asarray(returned)
        if indices.dtype.kind not in "iub":  # integers beyond 64 bits become objects or floats
            indices = np.asarray(returned, object)
    except ValueError:  # parts of different lengths
        return None
    if indices.dtype == object and not all(isinstance(index, int | np.integer) for index in indices.flat):
        return None
    return None if indices.ndim > 1 else indices

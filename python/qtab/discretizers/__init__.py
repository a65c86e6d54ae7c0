"""Discretizers map observations to the active rows of the Q table; one per file."""

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from qtab.config import Config
from qtab.discretizers import named
from qtab.discretizers.assigned_rows import AssignedRows
from qtab.discretizers.base import Discretizer
from qtab.discretizers.bins import Bins
from qtab.discretizers.composite import Composite
from qtab.discretizers.edges import Edges
from qtab.discretizers.function import Function
from qtab.discretizers.identity import Identity
from qtab.discretizers.named import DISCRETIZERS, is_plain
from qtab.discretizers.rounding import Rounding
from qtab.discretizers.tile_coding import TileCoding
from qtab.discretizers.time_aware import TimeAware


def build(space: Any, config: Config, n_actions: int) -> Discretizer:
    """Returns the discretizer of a config over an observation space; see :meth:`Discretizer.build`."""
    return (TimeAware.build if config.time_aware else named.build)(space, config, n_actions)


def restore(config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> Discretizer:
    """Returns the discretizer of a saved run; see :meth:`Discretizer.restore`."""
    return (TimeAware.restore if config.time_aware else named.restore)(config, arrays, n_rows)


Sparse = AssignedRows
"""An alias of :class:`AssignedRows`, its name in earlier versions."""

__all__ = [
    "DISCRETIZERS",
    "AssignedRows",
    "Bins",
    "Composite",
    "Discretizer",
    "Edges",
    "Function",
    "Identity",
    "Rounding",
    "Sparse",
    "TileCoding",
    "TimeAware",
    "build",
    "is_plain",
    "restore",
]

"""From an observation to the active rows of the Q table: one discretizer per file, found here by its name."""

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.choices import DiscretizerName
from qtab.discretizers.base import Discretizer
from qtab.discretizers.bins import Bins
from qtab.discretizers.edges import Edges
from qtab.discretizers.identity import Identity
from qtab.discretizers.rounding import Rounding
from qtab.discretizers.tile_coding import TileCoding

DISCRETIZERS: Mapping[DiscretizerName, type[Discretizer]] = {
    "round": Rounding,
    "bins": Bins,
    "edges": Edges,
    "tiles": TileCoding,
    "identity": Identity,
}
"""The class of each value of the setting ``discretizer``."""


def build(space: Any, config: Config, n_actions: int) -> Discretizer:
    """Returns the discretizer of a config over an observation space; see :meth:`Discretizer.build`."""
    return DISCRETIZERS[config.discretizer].build(space, config, n_actions)


def restore(config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> Discretizer:
    """Returns the discretizer of a saved run; see :meth:`Discretizer.restore`."""
    return DISCRETIZERS[config.discretizer].restore(config, arrays, n_rows)


__all__ = ["DISCRETIZERS", "Bins", "Discretizer", "Edges", "Identity", "Rounding", "TileCoding", "build", "restore"]

"""Makes the discretizer that a config names, for a space or from a file."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from gymnasium import spaces
from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.choices import FUNCTION, MAPPING, DiscretizerName
from qtab.config.validation import kind, uses_weighted
from qtab.discretizers.base import Discretizer
from qtab.discretizers.identity import integer_bounds
from qtab.envs.actions import FLOATS

DISCRETIZERS: Mapping[DiscretizerName, str] = {
    "round": "rounding:Rounding",
    "bins": "bins:Bins",
    "edges": "edges:Edges",
    "tiles": "tile_coding:TileCoding",
    "fourier": "weighted.fourier:FourierBasis",
    "polynomial": "weighted.polynomial:PolynomialBasis",
    "radial": "weighted.radial:RadialBasis",
    "coarse": "weighted.coarse:CoarseCoding",
    "identity": "identity:Identity",
}
"""The module and the class for each value of the setting ``discretizer``, for spaces that the extension reads
directly."""
_COMPOSITE, _ASSIGNED_ROWS = "composite:Composite", "assigned_rows:AssignedRows"
_OTHERS = {FUNCTION: "function:Function", MAPPING: _COMPOSITE}
PLACES = (*DISCRETIZERS.values(), *_OTHERS.values(), _ASSIGNED_ROWS, "time_aware:TimeAware")
"""All modules and classes of this package."""

MAX_AXES = 62
"""The maximum number of axes: NumPy arrays have at most 64, of which many runs use one for runs and one for actions."""


def build(space: Any, config: Config, n_actions: int) -> Discretizer:
    """Returns the discretizer of a config over an observation space; see :meth:`Discretizer.build`."""
    built = _class_of(config, plain=is_plain(space)).build(space, config, n_actions)
    if n_actions and len(built.shape) > MAX_AXES:
        owner = "shape" if kind(config.discretizer) == FUNCTION else "the observation space"
        raise ValueError(
            f"{owner} must give the table at most {MAX_AXES} axes, the limit of NumPy's arrays without those of runs "
            f"and actions; max_rows= assigns rows only to the observations that are seen, got {len(built.shape)}"
        )
    return built


def restore(config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> Discretizer:
    """Returns the discretizer of a saved run; see :meth:`Discretizer.restore`."""
    return _class_of(config, plain="layout" not in arrays).restore(config, arrays, n_rows)


def is_plain(space: Any) -> bool:
    """Returns whether the extension reads the observations of a space directly."""
    is_box = isinstance(space, spaces.Box) and len(space.shape) == 1 and space.dtype in FLOATS
    return is_box or integer_bounds(space) is not None


def class_at(place: str) -> type[Discretizer]:
    """Returns the class at ``"module:Class"`` in this package, such as a value of ``DISCRETIZERS``."""
    module, _, name = place.partition(":")
    found: type[Discretizer] = getattr(import_module(f"qtab.discretizers.{module}"), name)
    return found


def _class_of(config: Config, *, plain: bool) -> type[Discretizer]:
    chosen: Any = kind(config.discretizer)
    if config.max_rows is not None:
        return class_at(_ASSIGNED_ROWS)
    if chosen in _OTHERS:
        return class_at(_OTHERS[chosen])
    return class_at(DISCRETIZERS[chosen] if plain or uses_weighted(chosen) else _COMPOSITE)

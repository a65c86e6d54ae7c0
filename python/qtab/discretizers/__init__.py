"""Discretizers map observations to the active rows of the Q table; one per file, which is imported when it is used."""

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from qtab.config import Config
from qtab.discretizers import named
from qtab.discretizers.base import Discretizer
from qtab.discretizers.named import DISCRETIZERS, is_plain


def build(space: Any, config: Config, n_actions: int) -> Discretizer:
    """Returns the discretizer of a config over an observation space; see :meth:`Discretizer.build`."""
    if config.time_aware:
        from qtab.discretizers.time_aware import TimeAware

        return TimeAware.build(space, config, n_actions)
    return named.build(space, config, n_actions)


def restore(config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> Discretizer:
    """Returns the discretizer of a saved run; see :meth:`Discretizer.restore`."""
    if config.time_aware:
        from qtab.discretizers.time_aware import TimeAware

        return TimeAware.restore(config, arrays, n_rows)
    return named.restore(config, arrays, n_rows)


_CLASSES = {place.partition(":")[2]: place for place in sorted(named.PLACES)}
_CLASSES["Sparse"] = _CLASSES["AssignedRows"]  # its name in earlier versions


def __getattr__(name: str) -> type[Discretizer]:
    """Imports a class of this package when it is asked for."""
    if name not in _CLASSES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return named.class_at(_CLASSES[name])


__all__ = ["DISCRETIZERS", "Discretizer", *_CLASSES, "build", "is_plain", "restore"]

"""Bins between edges, of equal width or the user's own: ``numpy.digitize`` along each component."""

from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab import _spec
from qtab.config import Config
from qtab.discretizers.actions import Actions
from qtab.discretizers.base import Features, box, check_size, counts, limits


@dataclass(frozen=True)
class Bins(Features):
    """A grid of bins. What lies beyond the outermost edges belongs to the outermost bins."""

    edges: tuple[NDArray[np.floating], ...]
    """For each component the inner edges, one fewer than its bins."""
    limits: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
    """Two of (d,): what bins of equal width span."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Bins along each component, then the actions."""
        return (*(len(edges) + 1 for edges in self.edges), self.actions)

    def lit(self, observation: NDArray[Any]) -> list[int]:
        """Returns the rows of an observation: one.

        Raises:
            TypeError: if it holds no numbers.
            ValueError: if it has another shape than the space, or is NaN.
        """
        return [int(np.ravel_multi_index(self.cell(observation), self.shape[:-1]))]

    def cell(self, observation: NDArray[Any]) -> tuple[int, ...]:
        """Returns the index of an observation's row; an edge belongs to the bin above it.

        Raises:
            TypeError: if it holds no numbers.
            ValueError: if it has another shape than the space, or is NaN.
        """
        numbers = self.numbers(observation)
        return tuple(int(np.digitize(number, edges)) for number, edges in zip(numbers, self.edges, strict=True))

    def spec(self) -> _spec.BinsSpec:
        """Returns it as the extension module takes it."""
        edges = [edges.astype(np.float64).tolist() for edges in self.edges]
        return {"type": "bins", "dtype": self.float_type(), "edges": edges}


def bins(env: gym.Env, config: Config, actions: Actions) -> Bins:
    """Returns the bins over an environment's observations; ``config`` has its options' defaults filled in.

    Raises:
        ValueError: if a space or an option does not fit, or the table would be too large; it says which.
    """
    bounds = box(env)
    if config.discretizer == "edges":
        if config.edges is None or len(config.edges) != len(bounds[0]):
            raise ValueError(
                f"edges must hold {len(bounds[0])} rows of numbers for this observation space, got {config.edges!r}"
            )
        check_size("edges", config.edges, float(np.prod([len(row) + 1.0 for row in config.edges])) * actions.count)
        return of_config(*bounds, actions, config)
    low, high = limits(env, config.low, config.high)
    assert config.bins is not None  # noqa: S101 - filled in
    number = counts("bins", config.bins, env)
    check_size("bins", number, float(np.prod(np.array(number, np.float64))) * actions.count)
    complete = config.replace(bins=number, low=tuple(low.tolist()), high=tuple(high.tolist()))
    table = of_config(*bounds, actions, complete)
    if not all(np.isfinite(edges).all() for edges in table.edges):
        raise ValueError(f"high must not lie so far above low, got {low.tolist()} and {high.tolist()}")
    return table


def of_config(low: NDArray[Any], high: NDArray[Any], actions: Actions, config: Config) -> Bins:
    """Returns the bins of a config that leaves nothing open over a space of these bounds.

    Edges of equal width are computed in the dtype of the space, as by ``gymnasium.wrappers.DiscretizeObservation``; a
    user's own are double precision, as ``numpy.digitize`` takes them.
    """
    if config.edges is not None:
        return Bins(low, high, actions, tuple(np.array(row, dtype=np.float64) for row in config.edges))
    assert config.bins is not None  # noqa: S101 - resolved
    limits = np.array(config.low), np.array(config.high)
    with np.errstate(over="ignore", invalid="ignore"):
        axes = zip(*(limit.astype(low.dtype) for limit in limits), config.bins, strict=True)
        edges = tuple(np.linspace(first, last, count + 1)[1:-1] for first, last, count in axes)
    return Bins(low, high, actions, edges, limits)

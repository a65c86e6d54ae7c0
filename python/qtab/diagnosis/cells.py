"""Cells: they are too large to tell states apart, or the limits of the grid are too narrow or too wide."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Share, Unchecked, as_keywords, changes, percent

MOST_UNCHANGED = 0.5
"""A larger share of steps that stay in their cell is reported."""
GRIDS = ("round", "bins", "edges")


def coarse_grid(facts: Facts) -> Finding | Unchecked | None:
    """Finds that most steps do not change the cell, so that an update mostly uses the cell's own value."""
    config, sample = facts.config, facts.sample
    if config.discretizer not in GRIDS:
        return Unchecked("the states are not cells of a grid")
    if sample is None or len(sample.rows) == 0:
        return Unchecked("its last steps cannot be replayed")
    unchanged = float(np.mean((sample.rows == sample.next_rows).all(axis=1)))
    if unchanged <= MOST_UNCHANGED:
        return None
    shape = facts.run.discretizer.shape
    evidence = {"cells": float(np.prod(shape)), "share of steps that stay in their cell": Share(unchanged)}
    meaning = f"{percent(unchanged)} of the steps do not change the cell: the agent cannot see what they did."
    mixed = mixed_cells(facts)
    if mixed is not None:
        evidence["share of states whose best action is not their cell's"] = Share(mixed)
        meaning += f" {percent(mixed)} of the states need another action than most states of their cell."
    tiles = changes(config, *_tiles(facts))
    return Finding(
        title="The grid is too coarse.",
        evidence=evidence,
        meaning=meaning,
        advice="use a finer grid" + (", or tile coding, whose tilings overlap: discretizer='tiles'" if tiles else ""),
        changes=changes(config, *_finer(facts)) + tiles,
    )


def mixed_cells(facts: Facts) -> float | None:
    """Returns the share of visited states with another best action than most of their cell; None without an optimum."""
    best, sample = facts.optimum, facts.sample
    if best is None or best.search is None or sample is None:
        return None
    # The best action of each state in the sample, at the nearest point of the optimum's grid.
    axes = best.search.axes
    if len(axes) != sample.observations.shape[1]:
        return None
    points = tuple(
        np.abs(axis[np.newaxis] - sample.observations[::10, index, np.newaxis]).argmin(axis=1)
        for index, axis in enumerate(axes)
    )
    action, rows = best.policy[points], sample.rows[::10, 0]
    counts: NDArray[np.int64] = np.zeros((facts.run.discretizer.n_rows, len(facts.run.actions)), dtype=np.int64)
    np.add.at(counts, (rows, action), 1)
    return float(1.0 - counts.max(axis=1).sum() / len(rows))


def _finer(facts: Facts) -> tuple[dict[str, Any], ...]:
    config = facts.config
    if config.discretizer == "round" and config.scale:
        return ({"scale": tuple(2 * scale for scale in config.scale)},)
    if config.discretizer == "bins" and config.bins is not None:
        return ({"bins": tuple(2 * count for count in config.bins)},)
    return ()


def _tiles(facts: Facts) -> tuple[dict[str, Any], ...]:
    discretizer: Any = facts.run.discretizer
    if facts.config.time_aware or not (np.isfinite(discretizer.low) & np.isfinite(discretizer.high)).all():
        return ()
    # The article's grid has 15 to 19 cells along each component; with more components tables become large.
    return ({"discretizer": "tiles"} | ({"tiles": (16,)} if len(discretizer.low) <= 2 else {}),)


MOST_OUTSIDE = 0.2
"""A larger share of steps outside the limits is reported."""
ROOM_OUTSIDE = 0.25
"""The distance outside the limits, relative to their width, at which values of an unbounded component may lie."""
FEWEST_CELLS = 2.0
"""If fewer bins or tiles cover the range of a component, they hardly tell its values apart."""
UNBOUNDED = 1e30
"""Spaces of float32 without bounds have infinity, or the largest number of the dtype."""
ROOM = 2.0
"""The expected range of an unbounded component, in multiples of the range that was seen."""


def narrow_limits(facts: Facts) -> Finding | Unchecked | None:
    """Finds that many states lie outside the limits, where the outermost bin or tile holds them all."""
    found = _limits(facts)
    if isinstance(found, Unchecked):
        return found
    low, high, observed = found
    # The outermost bins of an unbounded component are meant to hold some values outside the limits.
    room = np.where(_bounds(facts)[2], 0.0, ROOM_OUTSIDE * (high - low))
    outside = (observed < low - room) | (observed > high + room)
    share = float(outside.any(axis=1).mean())
    if share <= MOST_OUTSIDE:
        return None
    component = int(outside.mean(axis=0).argmax())
    name = _name(facts, component, len(low))
    wide = _covering(facts, observed)
    return Finding(
        title="Many states lie outside the limits of the discretizer.",
        evidence={
            "share of the last steps outside": Share(share),
            f"lower limit of {name}": float(low[component]),
            f"upper limit of {name}": float(high[component]),
            "lowest value seen": float(observed[:, component].min()),
            "highest value seen": float(observed[:, component].max()),
        },
        meaning=f"In {percent(share)} of the last steps the outermost bin or tile holds the state: the agent cannot "
        "tell these states apart.",
        advice=f"use wider limits: {as_keywords(wide)}",
        changes=changes(facts.config, wide),
    )


def wide_limits(facts: Facts) -> Finding | Unchecked | None:
    """Finds limits so wide that the states lie in hardly more than one bin or tile."""
    found = _limits(facts)
    if isinstance(found, Unchecked):
        return found
    low, high, observed = found
    counts = np.broadcast_to(_counts(facts), low.shape)
    covered = counts * _range(facts, observed) / (high - low)
    coarse = (covered < FEWEST_CELLS) & (counts > FEWEST_CELLS)
    if not coarse.any():
        return None
    component = int(np.where(coarse, covered, np.inf).argmin())
    name, cells = _name(facts, component, len(low)), "tiles" if facts.config.discretizer == "tiles" else "bins"
    close = _within(_covering(facts, observed), low, high)
    return Finding(
        title="The limits of the discretizer are too wide to tell states apart.",
        evidence={
            f"{cells} of {name}": int(counts[component]),
            f"{cells} that its values cover": float(covered[component]),
        },
        meaning=f"The values of {name} lie within {covered[component]:.2g} of its {counts[component]} {cells}, so that "
        "states which need different actions share them.",
        advice=f"use closer limits: {as_keywords(close)}",
        changes=changes(facts.config, close),
    )


def _limits(facts: Facts) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]] | Unchecked:
    """Returns the limits of each component, and (steps, components): the observations."""
    config, sample = facts.config, facts.sample
    if config.discretizer not in ("bins", "tiles") or config.low is None or config.high is None:
        return Unchecked("the discretizer has no limits")
    if sample is None or len(sample.observations) == 0:
        return Unchecked("its last steps cannot be replayed")
    observed = np.asarray(sample.observations, dtype=np.float64).reshape(len(sample.observations), -1)
    return np.array(config.low), np.array(config.high), observed


def _counts(facts: Facts) -> Sequence[int]:
    counts = facts.config.bins if facts.config.discretizer == "bins" else facts.config.tiles
    return counts or (1,)


def _bounds(facts: Facts) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Returns the bounds of the observation space, and whether each component has them."""
    space: Any = None if facts.sample is None else facts.sample.space
    low, high = (np.array([float(str(bound)) for bound in np.ravel(limit)]) for limit in (space.low, space.high))
    return low, high, (np.abs(low) < UNBOUNDED) & (np.abs(high) < UNBOUNDED)


def _range(facts: Facts, observed: NDArray[np.float64]) -> NDArray[np.float64]:
    low, high, bounded = _bounds(facts)
    seen: NDArray[np.float64] = ROOM * (observed.max(axis=0) - observed.min(axis=0))
    return np.where(bounded, np.where(bounded, high, 0.0) - np.where(bounded, low, 0.0), seen)


def _covering(facts: Facts, observed: NDArray[np.float64]) -> dict[str, Any]:
    """Returns limits that hold all states: the bounds of the space, or the range that was seen with some room."""
    low, high, bounded = _bounds(facts)
    least, most = observed.min(axis=0), observed.max(axis=0)
    room = (most - least) / 10
    return {
        "low": tuple(np.where(bounded, low, _rounded(least - room, np.floor)).tolist()),
        "high": tuple(np.where(bounded, high, _rounded(most + room, np.ceil)).tolist()),
    }


def _within(close: dict[str, Any], low: NDArray[np.float64], high: NDArray[np.float64]) -> dict[str, Any]:
    """Returns limits that are nowhere wider than the present ones, so that no component loses cells."""
    closer_low, closer_high = np.maximum(low, close["low"]), np.minimum(high, close["high"])
    is_range = closer_low < closer_high
    return {
        "low": tuple(np.where(is_range, closer_low, low).tolist()),
        "high": tuple(np.where(is_range, closer_high, high).tolist()),
    }


def _name(facts: Facts, component: int, count: int) -> str:
    """Returns the name of one of ``count`` components of the observations."""
    return facts.run.axes[component - count].name  # with time_aware the steps taken come first


def _rounded(limits: NDArray[np.float64], outwards: Any) -> NDArray[np.float64]:
    """Rounds limits outwards to two digits."""
    exponents = np.floor(np.log10(np.maximum(np.abs(limits), 1e-12))).astype(int) - 1
    scaled = outwards(limits / 10.0**exponents)
    return np.array([float(f"{value:.0f}e{exponent}") for value, exponent in zip(scaled, exponents, strict=True)])

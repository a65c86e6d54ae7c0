"""Grid too coarse: states that need different actions share a cell."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.diagnosis.changes import changes
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Unchecked, percent

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
    evidence = {"cells": float(np.prod(shape)), "share of steps that stay in their cell": unchanged}
    meaning = f"{percent(unchanged)} of the steps do not change the cell: the agent cannot see what they did."
    mixed = mixed_cells(facts)
    if mixed is not None:
        evidence["share of states whose best action is not their cell's"] = mixed
        meaning += f" {percent(mixed)} of the states need another action than most states of their cell."
    tiles = changes(config, *_tiles(facts))
    return Finding(
        name="grid too coarse",
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

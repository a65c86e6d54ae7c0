"""Coverage: entries of the table that were never updated."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from qtab.diagnosis.changes import changes
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Unchecked, percent

MOST_UNTRIED = 0.2
"""A larger share of untried actions in visited states is reported."""
MOST_UPDATES = 100.0
"""With more updates per tried action, the other actions are untried because the agent avoids them."""
SHOWN = 3


def coverage(facts: Facts) -> Finding | Unchecked | None:
    """Finds that in many visited states some actions were never tried."""
    tried, visited = facts.tried, facts.visited
    entries = facts.has_action & visited[:, np.newaxis]
    if not entries.any():
        return Unchecked("no value changed")
    untried = float(1.0 - tried[entries].mean())
    if untried <= MOST_UNTRIED:
        return None
    run = facts.run
    per_entry = float(run.episode_lengths.sum()) * run.discretizer.n_active / max(int(tried.sum()), 1)
    if per_entry > MOST_UPDATES:
        return None
    states = np.flatnonzero((entries & ~tried).sum(axis=1))
    where = ", ".join(_place(facts, int(row)) for row in states[:SHOWN])
    more = 5 * facts.config.episodes
    return Finding(
        name="coverage",
        title="Many actions were never tried" + (", or their values never changed." if facts.visits is None else "."),
        evidence={
            "share of untried actions in visited states": untried,
            "visited states": int(visited.sum()),
            "states of the table": len(visited),
            "updates per tried action": per_entry,
        },
        meaning=f"{percent(untried)} of the values in visited states are still the initial ones, such as in {where}. "
        "The greedy policy compares them with learned values.",
        advice=f"train longer, such as episodes={more}, explore more, or use fewer cells",
        changes=changes(facts.config, {"episodes": more}, *_coarser(facts)),
    )


def _coarser(facts: Facts) -> tuple[Mapping[str, Any], ...]:
    config = facts.config
    if config.discretizer == "round" and config.scale:
        return ({"scale": tuple(scale / 2 for scale in config.scale)},)
    if config.discretizer == "bins" and config.bins is not None and max(config.bins) > 1:
        return ({"bins": tuple(max(1, count // 2) for count in config.bins)},)
    return ()


def _place(facts: Facts, row: int) -> str:
    discretizer = facts.run.discretizer
    if not discretizer.has_cells or len(discretizer.shape) == 1:
        return f"{'cell' if discretizer.has_cells else 'row'} {row}"
    return f"cell {tuple(int(index) for index in np.unravel_index(row, discretizer.shape))}"

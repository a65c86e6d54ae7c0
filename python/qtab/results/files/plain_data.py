"""A run's policy as JSON that any language can read; ``docs/how_to/export.md`` describes the format."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.files import replacing
from qtab.results.action_values import masked_tables
from qtab.results.files.consistency import check_consistent

if TYPE_CHECKING:
    from qtab.results.run import Run

FORMAT = "qtab policy"
FORMAT_VERSION = 1


def plain_data(run: "Run") -> dict[str, Any]:
    """Returns all data needed to follow a run's greedy policy, as numbers, strings, lists and dicts."""
    discretizer, actions = run.discretizer, run.actions
    return {
        "format": FORMAT,
        "version": FORMAT_VERSION,
        "env": str(run.config.env),
        "env_kwargs": dict(run.config.env_kwargs),
        "max_episode_steps": run.config.max_episode_steps,
        "algorithm": run.config.algorithm,
        "seed": run.config.seed,
        "episodes": len(run.episode_returns),
        "discretizer": dict(discretizer.spec()),
        "shape": list(discretizer.shape),
        "actions": [_plain(actions[column]) for column in range(len(actions))],
        "q_tables": list(map(_rows, masked_tables(run))),
        "versions": dict(run.versions),
    }


def write(run: "Run", path: Path) -> None:
    """Writes the policy of a run to a JSON file, completely or not at all.

    Raises:
        OSError: if the file cannot be written.
        TypeError: if the environment's keyword arguments are not JSON data.
        ValueError: if they hold a number that JSON cannot represent, the run is not one that training returns, its
            observations are nested, its discretizer is a function or assigns rows as observations are seen, or it
            combines tile coding with action masks.
    """
    try:
        check_consistent(run)
    except ValueError as error:
        raise ValueError(f"this run cannot be written: {error}") from None
    if run.config.time_aware:
        raise ValueError(
            "this run cannot be written: plain data describes policies without time_aware; "
            "run.at_step(step).to_json(path) writes the policy of one step"
        )
    if run.discretizer.reads_space:
        raise ValueError(
            "this run cannot be written: plain data describes discretizers of integers and of a Box of one axis of "
            f"floats, not {run.discretizer!r}"
        )
    if run.config.action_mask is not False and run.action_masks is None:
        raise ValueError("this run cannot be written: plain data holds the action masks of cells, not of tile coding")
    try:
        text = json.dumps(plain_data(run), allow_nan=False)
    except (TypeError, ValueError) as error:
        raise type(error)(f"env_kwargs must be JSON data, got {run.config.env_kwargs!r}: {error}") from None
    with replacing(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")


def _plain(action: Any) -> Any:
    """Returns an action as numbers, lists and dicts."""
    if isinstance(action, dict):
        return {name: _plain(part) for name, part in action.items()}
    if isinstance(action, tuple):
        return [_plain(part) for part in action]
    return action.tolist() if isinstance(action, np.ndarray | np.generic) else action


def _rows(table: NDArray[np.float64]) -> list[list[float | None]]:
    """Returns a list for each row, with None for the -inf of excluded actions."""
    rows: list[list[float | None]] = table.tolist()
    if np.isneginf(table).any():
        rows = [[None if value == -np.inf else value for value in row] for row in rows]
    return rows

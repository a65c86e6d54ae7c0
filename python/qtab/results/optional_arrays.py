"""The optional arrays of a run file: visits, action masks, snapshots and the average reward."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import shown
from qtab.results.snapshots import Snapshots

if TYPE_CHECKING:
    from qtab.results.run import Run


def optional_arrays(run: "Run") -> dict[str, NDArray[Any]]:
    """Returns the optional arrays to save."""
    arrays: dict[str, NDArray[Any]] = {}
    if run.visits is not None:
        arrays["visits"] = run.visits
    if run.action_masks is not None:
        arrays["action_masks"] = run.action_masks
    if run.snapshots is not None:
        arrays["snapshot_episodes"] = run.snapshots.episodes
        arrays["snapshot_tables"] = run.snapshots.tables
    if run.average_reward is not None:
        arrays["average_reward"] = np.array(run.average_reward)
    return arrays


def restore_optional(
    stored: Mapping[str, NDArray[Any]], tables: NDArray[np.float64], cells: tuple[int, ...], finished: int
) -> dict[str, Any]:
    """Returns the fields of a run that the optional arrays of a file hold, after checking them.

    Args:
        stored: The arrays in the file.
        tables: The run's tables.
        cells: The shape of its discretizer.
        finished: The number of finished episodes.

    Raises:
        KeyError: if one of the two arrays of snapshots is missing.
        ValueError: if the arrays do not fit the run.
    """
    fields: dict[str, Any] = {}
    if "visits" in stored:
        visits = stored["visits"]
        shape = (*cells, tables.shape[-1])
        if visits.dtype != np.int64 or visits.shape != shape or (visits < 0).any():
            raise ValueError(f"its visits are not counts of shape {shape}")
        fields["visits"] = visits
    if "action_masks" in stored:
        fields["action_masks"] = checked_masks(stored["action_masks"], (*cells, tables.shape[-1]))
    if "snapshot_episodes" in stored or "snapshot_tables" in stored:
        episodes, snapshots = stored["snapshot_episodes"], stored["snapshot_tables"]
        if episodes.dtype != np.int64 or episodes.ndim != 1 or (np.diff(episodes) <= 0).any():
            raise ValueError("its snapshots are not at ascending episodes")
        if len(episodes) and not 0 <= episodes[0] <= episodes[-1] <= finished:
            raise ValueError("its snapshots are not at episodes of the run")
        if snapshots.dtype != np.float64 or snapshots.shape != (len(episodes), *tables.shape):
            raise ValueError("its snapshots do not fit its tables")
        fields["snapshots"] = Snapshots(episodes, snapshots)
    if "average_reward" in stored:
        average = stored["average_reward"]
        if average.dtype != np.float64 or average.ndim != 0 or not np.isfinite(average):
            raise ValueError(f"its average_reward must be a finite number, got {shown(average)}")
        fields["average_reward"] = float(average)
    return fields


def checked_masks(masks: NDArray[Any], shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Returns the action masks in a file.

    Raises:
        ValueError: if the masks are not booleans of this shape, or leave a state without actions.
    """
    if masks.dtype != np.bool_ or masks.shape != shape or not masks.any(axis=-1).all():
        raise ValueError(f"its action masks are not booleans of shape {shape} that leave each state an action")
    return masks

"""The parts of the files of runs, written and restored: settings, actions and optional arrays."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.config.choices import FUNCTION
from qtab.config.config import DEFAULTS, Config, replace_checked
from qtab.config.functions import STORED, function_name
from qtab.config.options import OPTIONS, SETTINGS, fixed_settings
from qtab.config.validation import kind
from qtab.config.value_checks import MAX_ACTIONS
from qtab.envs.actions import ActionParts, Actions
from qtab.results.files import run_file
from qtab.results.files.consistency import check_consistent
from qtab.results.recording import Snapshots

if TYPE_CHECKING:
    from qtab.results.run import Run
    from qtab.results.runs import Runs


def write(
    path: Path, kind: str, result: "Run | Runs", header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]
) -> None:
    """Writes a file: the config, the discretizer and the actions of a result, and the caller's additions.

    Args:
        path: The file.
        kind: The format.
        result: The run, or the runs.
        header: Additional entries of the header.
        arrays: The arrays besides those of the discretizer and the actions.

    Raises:
        OSError: if the file cannot be written.
        TypeError: if the environment's keyword arguments are not JSON data.
        ValueError: if they hold a number that JSON cannot represent.
    """
    stored = dict(arrays) | result.discretizer.arrays()
    if result.actions.values is not None:
        stored["actions"] = result.actions.values
    config = stored_settings(result.config)
    if isinstance(result.config.initial_q, np.ndarray):
        stored["initial_q"] = result.config.initial_q
        config["initial_q"] = None
    content = {
        **_stored_function(config),
        "config": config,
        "actions": len(result.actions),
        "first_action": result.actions.first,
        "completed": result.completed,
        "seconds": result.seconds,
        "versions": dict(result.versions),
        **header,
    }
    if result.config.origin is not None:
        content["origin"] = result.config.origin.as_json()
    if result.actions.composite is not None:
        content["action_parts"] = describe_parts(result.actions)
    kwargs = result.config.env_kwargs
    try:
        text = run_file.encode(content, kind)
    except (TypeError, ValueError) as error:
        raise type(error)(f"env_kwargs must be JSON data, got {kwargs!r}: {error}") from None
    if replace_checked(result.config, env_kwargs=json.loads(text)["config"]["env_kwargs"]) != result.config:
        raise TypeError(f"env_kwargs must be JSON data, got {kwargs!r}: keys must be strings")
    run_file.write(path, text, stored)


def write_run(run: "Run", path: Any) -> None:
    """Writes the file of a run; see :meth:`qtab.Run.save`."""
    try:
        check_consistent(run)
    except ValueError as error:
        raise ValueError(f"this run cannot be saved: {error}") from None
    arrays = {name: getattr(run, name) for name in run_file.ARRAYS} | optional_arrays(run)
    header = {} if run.state is None else run.state.header()
    if run.state is not None:
        arrays["state"] = run.state.array()
    write(checks.file_path("path", path), run_file.RUN, run, header, arrays)


_KINDS = "biu"


def describe_parts(actions: Actions) -> Any:
    """Returns composite actions as JSON data."""
    if actions.composite is not None:
        parts = [describe_parts(part) for part in actions.composite.parts]
        keys = actions.composite.keys
        return {"parts": parts, "keys": None if keys is None else list(keys)}
    if actions.values is not None:
        return {"dtype": actions.values.dtype.name, "values": actions.values.tolist()}
    return {"count": actions.count, "first": actions.first}


def restore_actions(count: int, first: int, values: NDArray[Any] | None, description: Any) -> Actions:
    """Returns the actions in a file, after checking them.

    Raises:
        KeyError: if a part is missing.
        ValueError: if no action space has such actions.
    """
    if description is None:
        return Actions(count, first, values)
    actions = _restore(description)
    if actions.composite is None or actions.count != count or first != 0:
        raise ValueError("its actions contradict each other")
    return actions


def _restore(stored: Any) -> Actions:
    if not isinstance(stored, dict):
        raise ValueError(f"a part of its actions must be a JSON object, got {stored!r}")
    if "parts" in stored:
        parts, keys = tuple(map(_restore, stored["parts"])), stored["keys"]
        if keys is not None:
            keys = tuple(keys)
            if len(keys) != len(parts) or not all(isinstance(key, str) for key in keys):
                raise ValueError("the keys of its actions do not fit")
        count = math.prod(map(len, parts))
        _check_count(count)
        return Actions(count, composite=ActionParts(parts, keys))
    if "values" in stored:
        dtype = np.dtype(stored["dtype"])
        values = np.array(stored["values"])
        if dtype.kind not in _KINDS or values.dtype.kind not in _KINDS or not values.ndim:
            raise ValueError("the parts of its actions must be integers")
        _check_count(len(values))
        return Actions(len(values), values=values.astype(dtype))
    count, first = stored["count"], stored["first"]
    if type(count) is not int or type(first) is not int:
        raise ValueError(f"a part of its actions must have a count and a first action, got {stored!r}")
    _check_count(count)
    return Actions(count, first)


def _check_count(count: int) -> None:
    if not 1 <= count <= MAX_ACTIONS:
        raise ValueError(f"its actions must be 1 to {MAX_ACTIONS}, got {count}")


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


def _stored_function(config: dict[str, Any]) -> dict[str, str]:
    """Removes a function from the fields of a config; returns its entry in a file, empty if there is no function."""
    function = config["discretizer"]
    if kind(function) != FUNCTION:
        return {}
    config["discretizer"] = None
    return {"discretizer_function": function_name(function)}


ADDED = tuple(name for name, setting in SETTINGS.items() if setting.added)
"""Settings that earlier versions lack: files store them only if they differ from their defaults."""

IMPLIED = ("model",)
"""Options added to algorithms of earlier versions: files omit values that reproduce the earlier behavior."""


def stored_settings(config: Config) -> dict[str, Any]:
    """Returns the settings of a config by name. A function, which a file cannot store, is replaced by a word."""
    fields: Mapping[str, Any] = {name: getattr(config, name) for name in DEFAULTS}
    kept = {name: value for name, value in fields.items() if name not in ADDED or value != DEFAULTS[name]}
    for name in IMPLIED:
        if kept.get(name) == OPTIONS[name].default:
            del kept[name]
    return {name: STORED if name == "action_mask" and callable(value) else value for name, value in kept.items()}


def corrected_settings(stored: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the settings of a stored config with the values that were in effect.

    Earlier versions accepted other values of settings that are fixed for an algorithm, and ignored them.
    """
    return {**stored, **fixed_settings(stored.get("algorithm"))}


def implied_settings(config: Config) -> dict[str, Any]:
    """Returns the options that a stored config omits although they apply."""
    return {
        name: OPTIONS[name].default
        for name in IMPLIED
        if getattr(config, name) is None and getattr(config, OPTIONS[name].choice) in OPTIONS[name].values
    }

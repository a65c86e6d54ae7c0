"""``qtab.load`` and ``qtab.load_runs``: read saved runs, after checking their files."""

import logging
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

from qtab import discretizers
from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.config import DEFAULTS, Config
from qtab.config.config import replace_checked
from qtab.config.functions import STORED, MissingFunction
from qtab.config.origin import Origin, copied, trained_on
from qtab.config.validation import defaults
from qtab.discretizers.base import MAX_TABLE_SIZE
from qtab.envs.origin.description import from_json
from qtab.envs.origin.values import with_types
from qtab.envs.registry import stored_id
from qtab.results.files import run_file
from qtab.results.files.consistency import check_consistent, check_consistent_runs
from qtab.results.files.file_parts import (
    checked_masks,
    corrected_settings,
    implied_settings,
    restore_actions,
    restore_optional,
)
from qtab.results.run import Run
from qtab.results.run_state import RunState
from qtab.results.runs import Runs

_LOGGER = logging.getLogger("qtab")
Result = TypeVar("Result", Run, Runs)
_MAX_REASON = 400
"""The maximum length of the reason in an error, in characters: the reason may show values from the file."""


def load(
    path: "str | os.PathLike[str]",
    *,
    discretizer: Callable[[Any], Any] | None = None,
    action_mask: Callable[[Any], Any] | None = None,
) -> Run:
    """Reads a run that :meth:`qtab.Run.save` wrote, after checking that no byte of it was changed.

    :func:`qtab.load_runs` reads the file of many runs, and :func:`qtab.load_sweep` the store of a sweep.

    Files of earlier versions have no digest to check. They are read anyway; the logger ``qtab`` reports this, and
    ``run.unchecked`` is True.

    The environment that a file names is used only if it is registered with Gymnasium: no module is imported because a
    file names it. For ``"package:Name-v0"``, import the package first, or pass ``env=`` to the functions that need the
    environment.

    Args:
        path: The file.
        discretizer: The function that was the run's discretizer; a file holds only its name. Without the function the
            run can be loaded, but cannot read observations.
        action_mask: The function that gave the run's action masks, which a file cannot hold. Without the function the
            run can be inspected, and predicts only for the cells that it has seen.

    Raises:
        OSError: if the file is missing or cannot be read.
        TypeError: if ``discretizer`` is given and is not a function, or the run had none.
        ValueError: if the file is not a run file, is damaged, or comes from another version of the format; the message
            gives the reason.
    """
    return _load(path, "run file", run_file.RUN, _run, discretizer, action_mask)


def load_runs(
    path: "str | os.PathLike[str]",
    *,
    discretizer: Callable[[Any], Any] | None = None,
    action_mask: Callable[[Any], Any] | None = None,
) -> Runs:
    """Reads runs that :meth:`qtab.Runs.save` wrote, after checking that no byte of them was changed.

    As for :func:`qtab.load`, no module is imported because a file names it.

    Args:
        path: The file.
        discretizer: As for :func:`qtab.load`.
        action_mask: As for :func:`qtab.load`.

    Raises:
        OSError: if the file is missing or cannot be read.
        TypeError: if ``path`` is not a path, or ``discretizer`` is given and is not a function, or the runs had none.
        ValueError: if the file is not a file of runs, is damaged, or comes from another version of the format; the
            message gives the reason.
    """
    return _load(path, "file of runs", run_file.RUNS, _runs, discretizer, action_mask)


def _load(
    path: Any,
    name: str,
    kind: str,
    restore: Callable[[run_file.Content, Any], Result],
    discretizer: Any,
    action_mask: Any,
) -> Result:
    path = checks.file_path("path", path)
    with _opened(path, name) as file:
        content = run_file.read(file, kind)
        result = restore(content, discretizer)
    _check_function(discretizer, result.config)
    if not content.has_digest:
        _LOGGER.warning("%r has no digest, like all files of earlier versions: damage cannot be detected", str(path))
    if trained_on(result.config) is None:
        _LOGGER.warning(
            "%r stores only the id and the arguments of its environment, like all files of earlier versions: wrappers, "
            "changed attributes and bounds of spaces are not compared",
            str(path),
        )
    return result if action_mask is None else with_action_mask(result, action_mask)


def with_action_mask(run: Result, action_mask: Callable[[Any], Any]) -> Result:
    """Returns a run, or runs, from a file, with the function for action masks that the file cannot hold.

    Raises:
        TypeError: if ``action_mask`` is not a function.
        ValueError: if the run was not trained with a function.
    """
    if not callable(action_mask):
        raise TypeError(f"action_mask must be a function of the observation, got {shown(action_mask)}")
    if run.config.action_mask != STORED:
        raise ValueError("action_mask must be left out for a run that was not trained with a function")
    return replace(run, config=replace_checked(run.config, action_mask=action_mask))


@contextmanager
def _opened(path: Path, kind: str) -> Iterator[BinaryIO]:
    """Opens a file; turns errors while reading it into a ValueError that names the file and the expected kind.

    A FIFO raises an error, since reading it would wait until something is written.

    Raises:
        OSError: if the file is missing or cannot be read.
        ValueError: for any exception inside the context.
    """
    if path.is_fifo():
        raise OSError(f"path must be a regular file, got the FIFO {str(path)!r}")
    with path.open("rb") as file:
        try:
            yield file
        except Exception as error:  # a damaged file can raise almost anything
            reason = f"it has no {error.args[0]!r}" if isinstance(error, KeyError) else " ".join(str(error).split())
            reason = reason[:_MAX_REASON]
            raise ValueError(f"{str(path)!r} is not a {kind} that this version of qtab can read: {reason}") from None


def _check_function(function: Any, config: Config) -> None:
    """Checks that a function is given only if the discretizer was a function.

    Raises:
        TypeError: if ``function`` is not a function, or the discretizer was not one.
    """
    if function is not None and (isinstance(config.discretizer, str | dict) or not callable(function)):
        had = f"{config.discretizer!r}, not a function" if isinstance(config.discretizer, str | dict) else "a function"
        raise TypeError(f"discretizer must be that of the file, which is {had}, got {shown(function)}")


def _run(content: run_file.Content, function: Callable[[Any], Any] | None) -> Run:
    header, stored = content.header, content.arrays
    arrays: dict[str, Any] = {name: run_file.array(stored, name) for name in run_file.ARRAYS}
    shared = _shared_fields(content, function)
    config = shared["config"]
    discretizer = discretizers.restore(config, stored, arrays["tables"].shape[1])
    arrays |= restore_optional(stored, arrays["tables"], discretizer.shape, len(arrays["episode_returns"]))
    run = Run(
        discretizer=discretizer,
        unchecked=not content.has_digest,
        state=_state(header, stored["state"]) if "state" in stored else None,
        **shared,
        **arrays,
    )
    check_consistent(run)
    return run


def _runs(content: run_file.Content, function: Callable[[Any], Any] | None) -> Runs:
    if not content.has_digest:
        raise ValueError("its digest is missing")
    header, stored = content.header, content.arrays
    arrays: dict[str, Any] = {
        name: run_file.array(stored, name, more_axes=1)
        for name in run_file.ARRAYS
        if name != "tables" or "tables" in stored
    }
    shared = _shared_fields(content, function)
    seeds = header["seeds"]
    if not isinstance(seeds, list):
        raise ValueError(f"its seeds must be a list, got {seeds!r}")
    rows = _integer(header, "rows")
    if not rows < MAX_TABLE_SIZE:  # without tables, a small file may claim any number of rows
        raise ValueError(f"its number of rows must be less than 2**32, got {rows}")
    discretizer = discretizers.restore(shared["config"], stored, rows)
    if "action_masks" in stored:
        arrays["action_masks"] = checked_masks(
            stored["action_masks"], (len(seeds), *discretizer.shape, len(shared["actions"]))
        )
    runs = Runs(
        seeds=tuple(seeds),
        discretizer=discretizer,
        **shared,
        **{"tables": None, **arrays},
    )
    check_consistent_runs(runs)
    return runs


def _shared_fields(content: run_file.Content, function: Callable[[Any], Any] | None) -> dict[str, Any]:
    """Returns the fields that the files of one run and of many runs have in common.

    Args:
        content: The content of the file.
        function: The function that was the discretizer, if given.

    Raises:
        KeyError: if a field is missing.
        TypeError: if the config has an unknown setting.
        ValueError: if a field has an impossible value.
    """
    header, stored = content.header, content.arrays
    seconds, versions = header["seconds"], header["versions"]
    if isinstance(seconds, bool) or not isinstance(seconds, int | float):
        raise ValueError(f"its seconds must be a number, got {seconds!r}")
    if not isinstance(versions, dict) or not all(isinstance(version, str) for version in versions.values()):
        raise ValueError(f"its versions must map names to texts, got {versions!r}")
    return {
        "config": _config(header, stored, function),
        "actions": restore_actions(
            _integer(header, "actions"),
            _integer(header, "first_action"),
            stored.get("actions"),
            header.get("action_parts"),
        ),
        "completed": header["completed"],
        "seconds": float(seconds),
        "versions": versions,
    }


def _state(header: Mapping[str, Any], array: Any) -> RunState:
    # Earlier versions, which did not continue snapshots or record extensions, wrote neither.
    return RunState.restore(array, header["generator"], header.get("snapshots", []), header.get("extensions", []))


def _config(header: Mapping[str, Any], stored: Mapping[str, Any], function: Callable[[Any], Any] | None) -> Config:
    fields = corrected_settings(header["config"])
    name = header.get("discretizer_function")
    if fields["discretizer"] is None and isinstance(name, str):
        fields["discretizer"] = function if callable(function) else MissingFunction(name)
    if fields["initial_q"] is None:
        fields["initial_q"] = stored["initial_q"]
    fields["env"] = stored_id(fields["env"])
    config = Config(**fields)
    origin, implied = _origin(header), implied_settings(config)
    if origin is not None and origin.environment is not None:
        implied["env_kwargs"] = with_types(config.env_kwargs, origin.environment.kwargs)
    config = copied(replace_checked(config, **implied), origin)
    if config.seed is None or config.max_episode_steps is None or defaults(vars(config)):
        raise ValueError("its config is not that of a run")
    return config


def _origin(header: Mapping[str, Any]) -> Origin | None:
    """Returns the origin that a file stores; None for files of earlier versions."""
    if "origin" not in header:
        return None
    content = header["origin"]
    environment, derived = content["environment"], content["derived"]
    if not isinstance(derived, list) or not set(derived) <= DEFAULTS.keys():
        raise ValueError(f"its derived settings are not names of settings: {derived!r}")
    return Origin(None if environment is None else from_json(environment), frozenset(derived))


def _integer(header: Mapping[str, Any], name: str) -> int:
    """Returns an integer from a header.

    Raises:
        KeyError: if ``name`` is missing.
        ValueError: if the value is not an integer.
    """
    value = header[name]
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"its number of {name} must be an integer, got {value!r}")
    return value

"""Writes the parts that the files of one run and of many runs have in common."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab.config.config import replace_checked
from qtab.config.functions import stored_function
from qtab.config.stored import stored_settings
from qtab.results import run_file
from qtab.results.saved_actions import describe_parts

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
        **stored_function(config),
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

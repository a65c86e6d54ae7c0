"""``qtab.load``: a saved run, of whose file nothing is believed before it is checked."""

import logging
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from qtab import discretizers
from qtab._utils.shown import shown
from qtab.config import Config
from qtab.config.discretizer import MissingFunction
from qtab.config.options import defaults
from qtab.discretizers.actions import Actions
from qtab.envs.stored import stored_id
from qtab.results import run_file
from qtab.results.consistency import check_consistent
from qtab.results.optional_arrays import restore_optional
from qtab.results.run import Run
from qtab.results.run_state import RunState

_LOGGER = logging.getLogger("qtab")
_MAX_REASON = 400
"""The characters of the reason in an error: it may show values from the file."""


def load(path: "str | os.PathLike[str]", *, discretizer: Callable[[Any], Any] | None = None) -> Run:
    """Reads a run that :meth:`qtab.Run.save` wrote, after checking that not a byte of it was changed.

    Files of earlier versions have no digest to check it by. They are read all the same, with a message of the logger
    ``qtab`` that says so, and ``run.unchecked`` is True.

    The environment that a file names is used only if it is registered with Gymnasium: no module is imported because a
    file names it. For ``"package:Name-v0"`` import the package first, or pass ``env=`` to what needs the environment.

    Args:
        path: The file.
        discretizer: The function that was the run's discretizer, of which a file holds only the name. Without it the
            run is loaded as well, but cannot read an observation.

    Raises:
        OSError: if the file is missing or cannot be read.
        TypeError: if ``discretizer`` is given and is not a function, or the run had none.
        ValueError: if it is not a run file, is damaged, or comes from another version of the format; the
            message says why.
    """
    path = Path(path)
    with _open_regular(path) as file:
        try:
            content = run_file.read(file)
            function = _function(content.header)
            run = _run(content, function if discretizer is None else discretizer)
        except Exception as error:  # a damaged file can raise almost anything
            reason = f"it has no {error.args[0]!r}" if isinstance(error, KeyError) else " ".join(str(error).split())
            reason = reason[:_MAX_REASON]
            raise ValueError(f"{str(path)!r} is not a run file that this version of qtab can read: {reason}") from None
    if discretizer is not None and (function is None or not callable(discretizer)):
        had = f"{run.config.discretizer!r}, no function" if function is None else "a function"
        raise TypeError(f"discretizer must be the run's, which is {had}, got {shown(discretizer)}")
    if run.unchecked:
        _LOGGER.warning(
            "%r has no digest, as files of earlier versions: that it is undamaged is not checked", str(path)
        )
    return run


def _open_regular(path: Path) -> BinaryIO:
    """Opens a file; a FIFO, which would be waited for until something is written to it, is refused."""
    if path.is_fifo():
        raise OSError(f"path must be a regular file, got the FIFO {str(path)!r}")
    return path.open("rb")


def _function(header: Mapping[str, Any]) -> MissingFunction | None:
    name = header.get("discretizer_function")
    return MissingFunction(name) if isinstance(name, str) and header["config"]["discretizer"] is None else None


def _run(content: run_file.Content, function: Callable[[Any], Any] | None) -> Run:
    header, stored = content.header, content.arrays
    arrays: dict[str, Any] = {name: run_file.array(stored, name) for name in run_file.ARRAYS}
    config = _config(header, stored, function)
    actions = Actions(_integer(header, "actions"), _integer(header, "first_action"), stored.get("actions"))
    seconds, versions = header["seconds"], header["versions"]
    if isinstance(seconds, bool) or not isinstance(seconds, int | float):
        raise ValueError(f"its seconds must be a number, got {seconds!r}")
    if not isinstance(versions, dict) or not all(isinstance(version, str) for version in versions.values()):
        raise ValueError(f"its versions must map names to texts, got {versions!r}")
    discretizer = discretizers.restore(config, stored, arrays["tables"].shape[1])
    arrays |= restore_optional(stored, arrays["tables"], discretizer.shape, len(arrays["episode_returns"]))
    run = Run(
        config=config,
        discretizer=discretizer,
        actions=actions,
        completed=header["completed"],
        seconds=float(seconds),
        versions=versions,
        unchecked=not content.has_digest,
        state=RunState.restore(stored["state"], header["generator"]) if "state" in stored else None,
        **arrays,
    )
    check_consistent(run)
    return run


def _config(header: Mapping[str, Any], stored: Mapping[str, Any], function: Callable[[Any], Any] | None) -> Config:
    fields = dict(header["config"])
    if fields["discretizer"] is None and function is not None:
        fields["discretizer"] = function
    if fields["initial_q"] is None:
        fields["initial_q"] = stored["initial_q"]
    fields["env"] = stored_id(fields["env"])
    config = Config(**fields)
    if config.seed is None or config.max_episode_steps is None or defaults(vars(config)):
        raise ValueError("its config is not that of a run")
    return config


def _integer(header: Mapping[str, Any], name: str) -> int:
    value = header[name]
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"its number of {name} must be an integer, got {value!r}")
    return value

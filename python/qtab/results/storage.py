"""``qtab.load``: a saved run, of whose file nothing is believed before it is checked."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab import discretizers
from qtab.config import Config
from qtab.config.options import defaults, n_tables
from qtab.discretizers.actions import Actions
from qtab.results import run_file
from qtab.results.run import Run
from qtab.results.run_state import RunState


def load(path: "str | os.PathLike[str]") -> Run:
    """Reads a run that :meth:`qtab.Run.save` wrote.

    Raises:
        OSError: if the file is missing or cannot be read.
        ValueError: if it is not a run file, is damaged, or comes from another version of the format; the
            message says why.
    """
    path = Path(path)
    with path.open("rb") as file:
        try:
            with run_file.reading(file) as (header, arrays):
                return _run(header, arrays)
        except Exception as error:  # a damaged file can raise almost anything
            reason = str(error)
            if isinstance(error, KeyError):
                reason = f"it has no {str(error.args[0]).removesuffix(' is not a file in the archive')!r}"
            raise ValueError(f"{str(path)!r} is not a run file that this version of qtab can read: {reason}") from None


def _run(header: Mapping[str, Any], stored: Mapping[str, NDArray[Any]]) -> Run:
    arrays: dict[str, Any] = {name: run_file.array(stored, name) for name in run_file.ARRAYS}
    fields = dict(header["config"])
    if fields["initial_q"] is None:
        fields["initial_q"] = stored["initial_q"]
    config = Config(**fields)
    if config.seed is None or config.max_episode_steps is None or defaults(vars(config)):
        raise ValueError("its config is not that of a run")
    actions = Actions(int(header["actions"]), int(header["first_action"]), stored.get("actions"))
    run = Run(
        config=config,
        discretizer=discretizers.restore(config, stored, arrays["tables"].shape[1]),
        actions=actions,
        completed=len(arrays["episode_returns"]) == config.episodes,
        seconds=float(header["seconds"]),
        versions={str(key): str(value) for key, value in header["versions"].items()},
        state=RunState.restore(stored["state"], header["generator"]) if "state" in stored else None,
        **arrays,
    )
    with np.errstate(all="raise"):
        _check(run)
    if header["completed"] is not run.completed:
        raise ValueError("its header does not agree with the number of its episodes")
    return run


def _check(run: Run) -> None:
    config, discretizer = run.config, run.discretizer
    if not run.actions.match(config):
        raise ValueError("its actions are not those of its config")
    k, rows, actions = n_tables(config.algorithm), discretizer.n_rows, len(run.actions)
    if run.tables.shape != (k, rows, actions) or actions < 1:
        raise ValueError(f"its tables have shape {run.tables.shape}, which does not fit its {discretizer.shape} rows")
    if isinstance(config.initial_q, np.ndarray):
        shape = (*discretizer.shape, actions)
        if config.initial_q.shape not in (shape if k == 1 else (k, *shape), (k, rows, actions)):
            raise ValueError(f"its initial_q has shape {config.initial_q.shape}, which does not fit its table {shape}")
    lengths = {len(run.episode_returns), len(run.episode_lengths), len(run.terminated)}
    if len(lengths) != 1 or lengths.pop() > config.episodes:
        raise ValueError("its episodes do not fit together")

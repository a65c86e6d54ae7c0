"""``qtab.load_runs``: many saved runs, whose file is checked before use."""

import os
from collections.abc import Callable
from typing import Any

from qtab import discretizers
from qtab._utils import checks
from qtab.discretizers.base import MAX_TABLE_SIZE
from qtab.results import run_file
from qtab.results.consistency import check_consistent_runs
from qtab.results.optional_arrays import checked_masks
from qtab.results.runs import Runs
from qtab.results.storage import check_function, integer, log_unknown_origin, opened, shared_fields, with_action_mask


def load_runs(
    path: "str | os.PathLike[str]",
    *,
    discretizer: Callable[[Any], Any] | None = None,
    action_mask: Callable[[Any], Any] | None = None,
) -> Runs:
    """Reads runs that :meth:`qtab.Runs.save` wrote, after checking that not a byte of them was changed.

    As for :func:`qtab.load`, no module is imported because a file names it.

    Args:
        path: The file.
        discretizer: As for :func:`qtab.load`.
        action_mask: As for :func:`qtab.load`.

    Raises:
        OSError: if the file is missing or cannot be read.
        TypeError: if ``path`` is not a path, or ``discretizer`` is given and is not a function, or the runs had none.
        ValueError: if it is not a file of runs, is damaged, or comes from another version of the format; the message
            says why.
    """
    path = checks.file_path("path", path)
    with opened(path, "file of runs") as file:
        runs = _runs(run_file.read(file, run_file.RUNS), discretizer)
    check_function(discretizer, runs.config)
    log_unknown_origin(path, runs.config)
    return runs if action_mask is None else with_action_mask(runs, action_mask)


def _runs(content: run_file.Content, function: Callable[[Any], Any] | None) -> Runs:
    if not content.has_digest:
        raise ValueError("its digest is missing")
    header, stored = content.header, content.arrays
    arrays: dict[str, Any] = {
        name: run_file.array(stored, name, more_axes=1)
        for name in run_file.ARRAYS
        if name != "tables" or "tables" in stored
    }
    shared = shared_fields(content, function)
    seeds = header["seeds"]
    if not isinstance(seeds, list):
        raise ValueError(f"its seeds must be a list, got {seeds!r}")
    rows = integer(header, "rows")
    if not rows < MAX_TABLE_SIZE:  # a file without tables may be much smaller than what its rows would need
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

"""A run in one ``.npz`` file: arrays and a JSON header. Nothing in it is ever unpickled."""

import dataclasses
import json
import math
import os
import zipfile
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from qtab._utils.files import check_writable, replacing
from qtab.config import Config
from qtab.config.options import defaults, n_tables
from qtab.discretizers import bins
from qtab.discretizers.actions import FLOATS, Actions
from qtab.discretizers.base import Features
from qtab.discretizers.bins import Bins
from qtab.discretizers.identity import Cells
from qtab.discretizers.rounding import Grid
from qtab.discretizers.tile_coding import Tiling
from qtab.results.run import Run

FORMAT = "qtab run"
FORMAT_VERSION = 1

_ARRAYS = {
    "tables": (np.dtype(np.float64), 3),
    "episode_returns": (np.dtype(np.float64), 1),
    "episode_lengths": (np.dtype(np.int64), 1),
    "terminated": (np.dtype(np.bool_), 1),
}


def save(run: Run, path: Path) -> None:
    """Writes a run; see :meth:`qtab.Run.save`."""
    check_writable("path", path)
    arrays = {name: getattr(run, name) for name in _ARRAYS}
    arrays |= {"low": run.grid.low, "high": run.grid.high}
    if isinstance(run.grid, Grid):
        arrays["scale"] = run.grid.scale
    if run.grid.choices.values is not None:
        arrays["actions"] = run.grid.choices.values
    config = {field.name: getattr(run.config, field.name) for field in dataclasses.fields(Config)}
    if isinstance(run.config.initial_q, np.ndarray):
        arrays["initial_q"] = run.config.initial_q
        config["initial_q"] = None
    header = {
        "format": FORMAT,
        "version": FORMAT_VERSION,
        "config": config,
        "actions": run.grid.actions,
        "first_action": run.grid.first_action,
        "completed": run.completed,
        "seconds": run.seconds,
        "versions": dict(run.versions),
    }
    try:
        text = json.dumps(header, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise type(error)(f"env_kwargs must hold what JSON can, got {config['env_kwargs']!r}: {error}") from None
    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez(file, header=np.array(text), **arrays)


def load(path: "str | os.PathLike[str]") -> Run:
    """Reads a run that :meth:`qtab.Run.save` wrote.

    Raises:
        OSError: if the file is missing or cannot be read.
        ValueError: if it is no run, is damaged, or comes from another version of the format; it says which.
    """
    path = Path(path)
    with path.open("rb") as file:
        try:
            return _load(file)
        except Exception as error:  # there is no end to the ways in which a file can be damaged
            reason = f"it has no {error}" if isinstance(error, KeyError) else str(error)
            raise ValueError(f"{str(path)!r} is no run that this version of qtab can read: {reason}") from None


def _load(opened: BinaryIO) -> Run:
    with zipfile.ZipFile(opened) as archive:
        # What is stored as it is cannot be larger than the file: no memory is claimed for what is not there.
        if any(entry.compress_type != zipfile.ZIP_STORED for entry in archive.infolist()):
            raise ValueError("it is compressed, which qtab's files are not")
    opened.seek(0)
    with np.load(opened, allow_pickle=False) as file:
        header = json.loads(str(file["header"]))
        if not isinstance(header, dict) or header.get("format") != FORMAT:
            raise ValueError("its header is not one of qtab's")
        if header["version"] != FORMAT_VERSION:
            raise ValueError(f"its format has version {header['version']!r}, this one reads {FORMAT_VERSION}")
        arrays = {name: _array(file, name, dtype, ndim) for name, (dtype, ndim) in _ARRAYS.items()}
        fields = dict(header["config"])
        if fields["initial_q"] is None:
            fields["initial_q"] = file["initial_q"]
        config = Config(**fields)
        choices = Actions(int(header["actions"]), int(header["first_action"]), file.get("actions"))
        features = _features(config, file, choices, arrays["tables"].shape[1])
    with np.errstate(all="raise"):
        _check_shapes(config, features, arrays)
    completed = len(arrays["episode_returns"]) == config.episodes
    if header["completed"] is not completed:
        raise ValueError("its episodes are not as many as its header says")
    return Run(
        config=config,
        grid=features,
        completed=completed,
        seconds=float(header["seconds"]),
        versions={str(key): str(value) for key, value in header["versions"].items()},
        **arrays,
    )


def _array(file: Any, name: str, dtype: "np.dtype[Any]", ndim: int) -> Any:
    array = file[name]
    if array.dtype != dtype or array.ndim != ndim:
        raise ValueError(f"its {name} has dtype {array.dtype} and {array.ndim} axes, not {dtype} and {ndim}")
    return array


def _features(config: Config, file: Any, choices: Actions, rows: int) -> Features:
    low, high = file["low"], file["high"]
    if config.discretizer == "identity":
        return Cells(low, high, choices)
    if config.discretizer == "round":
        return Grid(low, high, choices, file["scale"])
    if config.discretizer == "edges" and config.edges is not None:
        return bins.of_config(low, high, choices, config)
    if config.low is not None and config.high is not None:
        # No more edges are computed than there are rows.
        if config.discretizer == "bins" and config.bins is not None and math.prod(config.bins) == rows:
            return bins.of_config(low, high, choices, config)
        if config.tiles is not None and config.tilings is not None:
            edges = np.array(config.low), np.array(config.high)
            return Tiling(low, high, choices, edges, config.tiles, config.tilings, config.hashed_rows)
    raise ValueError("its config is not that of a run")


def _are_actions_of(config: Config, choices: Actions) -> bool:
    values, wanted = choices.values, config.actions
    if values is None or wanted is None:
        return values is None and wanted is None
    if values.dtype not in FLOATS or values.ndim != 2 or len(values) != choices.count or not np.isfinite(values).all():
        return False
    components = values.shape[1]
    if isinstance(wanted, int):
        return components > 0 and bool(len(values) == wanted**components)
    return np.array_equal(np.array(wanted, values.dtype).reshape(-1, components), values)


def _check_shapes(config: Config, features: Features, arrays: dict[str, Any]) -> None:
    if config.seed is None or config.max_episode_steps is None or defaults(vars(config)):
        raise ValueError("its config is not that of a run")
    low, high = features.low, features.high
    if low.dtype not in ((np.dtype(np.int64),) if isinstance(features, Cells) else FLOATS) or high.dtype != low.dtype:
        raise ValueError("its bounds are not those of a space")
    if isinstance(features, Grid):
        bounds = (low, high, features.scale)
        if any(bound.shape != (len(config.scale),) or not np.isfinite(bound).all() for bound in bounds):
            raise ValueError("its bounds do not fit its scale")
        if tuple(features.scale) != config.scale:
            raise ValueError("its bounds are not those of a space")
    elif isinstance(features, Cells):
        if low.shape != high.shape or low.ndim > 1 or (low > high).any():
            raise ValueError("its bounds are not those of a discrete space")
    elif isinstance(features, Bins):
        if (
            low.shape != high.shape
            or low.shape != (len(features.edges),)
            or not all(np.isfinite(edges).all() for edges in features.edges)
        ):
            raise ValueError("its bounds do not fit its bins")
    elif isinstance(features, Tiling) and {edge.shape for edge in (low, high, *features.edges)} != {
        (len(features.tiles),)
    }:
        raise ValueError("its bounds do not fit its tiles")
    if not _are_actions_of(config, features.choices):
        raise ValueError("its actions are not those of its config")
    shape, expected = arrays["tables"].shape, (n_tables(config.algorithm), features.rows, features.actions)
    if shape != expected or features.actions < 1:
        raise ValueError(f"its tables have shape {shape}, which does not fit the grid {features.shape}")
    if isinstance(config.initial_q, np.ndarray) and config.initial_q.shape not in (
        features.shape if expected[0] == 1 else (expected[0], *features.shape),
        expected,
    ):
        raise ValueError(
            f"its initial_q has shape {config.initial_q.shape}, which does not fit the grid {features.shape}"
        )
    lengths = {len(arrays[name]) for name in ("episode_returns", "episode_lengths", "terminated")}
    if len(lengths) != 1 or lengths.pop() > config.episodes:
        raise ValueError("its episodes do not fit together")

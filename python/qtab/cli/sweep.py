"""``qtab sweep``."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyro

from qtab._utils.progress import ProgressBar, print_above
from qtab._utils.suggestions import did_you_mean
from qtab.cli.parsing import parse
from qtab.cli.usage import UsageError, usage_errors
from qtab.sweeps import SweepProgress, designs, sweep

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

COMMAND = "qtab sweep"
_KEYS = ("env", "seeds", "block", "store", "grid", "design", "config")


@dataclass(frozen=True)
class Arguments:
    """Train every setting of a study with the same seeds. An interrupted sweep resumes if it is called again."""

    study: tyro.conf.Positional[Path]
    """A TOML file: env, seeds, [grid] (or [design] with kind, points, seed and space), [config], block and store."""
    store: Path | None = None
    """The SQLite file for the results; by default the one that the study names, or the study's name with suffix .db."""
    threads: int | None = None
    """The number of threads, or of processes for environments stepped in Python; by default one per core."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with usage_errors():
        study = _read(options.study)
        for key in study:
            if key not in _KEYS:
                raise ValueError(
                    f"{options.study}: unknown key {key!r}{did_you_mean(key, _KEYS)}; use {', '.join(_KEYS)}"
                )
        store = options.store or options.study.parent / study.get("store", options.study.with_suffix(".db").name)
        grid = _grid(study)
        config = study.get("config", {})
        seeds = study.get("seeds", 100)
        with ProgressBar(len(grid) * _seed_count(seeds), "run", None, options.study.stem) as bar:

            def show(progress: SweepProgress) -> None:
                bar.move_to(progress.runs)

            env, block = study.get("env", "MountainCar-v0"), study.get("block", 100)
            result = sweep(env, grid, seeds, store=store, threads=options.threads, block=block, callback=show, **config)
    runs, settings = _counted(len(result), "run"), _counted(len(result.settings), "setting")
    print_above(f"{runs} of {settings} in {store}, {result.failed} failed")
    return 0


def _read(path: Path) -> dict[str, Any]:
    with path.open("rb") as file:
        try:
            return tomllib.load(file)
        except ValueError as error:
            raise ValueError(f"study must be a TOML file, got {str(path)!r}: {error}") from None


def _counted(count: int, unit: str) -> str:
    return f"{count:,} {unit}{'' if count == 1 else 's'}"


def _seed_count(seeds: Any) -> int:
    return len(seeds) if isinstance(seeds, list) else seeds if isinstance(seeds, int) else 1


def _grid(study: Mapping[str, Any]) -> list[dict[str, Any]]:
    if ("grid" in study) == ("design" in study):
        raise UsageError("a study must have either a [grid] or a [design]")
    if "grid" in study:
        return designs.grid(
            {name: [_tuple(value) for value in _list(name, row)] for name, row in study["grid"].items()}
        )
    design = dict(study["design"])
    kind = design.pop("kind", "sobol")
    if kind not in ("random", "sobol") or not design.keys() <= {"points", "seed", "space"} or "points" not in design:
        raise UsageError("[design] must have kind = 'random' or 'sobol', points, space and optionally seed")
    space = {name: _axis(axis) for name, axis in design.get("space", {}).items()}
    make = designs.random if kind == "random" else designs.sobol
    return make(space, design["points"], design.get("seed", 0))


def _list(name: str, values: Any) -> Any:
    if not isinstance(values, list):
        raise UsageError(f"grid[{name!r}] must be a list of values, got {values!r}")
    return values


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _axis(axis: Any) -> Any:
    """Returns an axis of a design from ``{low = 0.01, high = 1.0, log = true}`` or a list of choices."""
    if not isinstance(axis, dict):
        return axis
    bounds = (axis.get("low"), axis.get("high"))
    return (*bounds, "log") if axis.get("log") else bounds

"""``qtab sweep``."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyro

from qtab._utils.progress import ProgressBar, print_above
from qtab.cli.parsing import parse
from qtab.cli.usage import UsageError, refusing
from qtab.sweeps import SweepProgress, designs, sweep

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

COMMAND = "qtab sweep"
_PARTS = ("env", "seeds", "block", "store", "grid", "design", "config")


@dataclass(frozen=True)
class Arguments:
    """Train every setting of a study over the same seeds. Stopped or killed and called again, it goes on."""

    study: tyro.conf.Positional[Path]
    """A TOML file: env, seeds, [grid] (or [design] with kind, points, seed and space), [config], block, store."""
    store: Path | None = None
    """Where results are kept; the study's own word, or its name with the ending .db, where it is not given."""
    threads: int | None = None
    """How many threads, or processes for what is stepped in Python; one a core where it is not given."""


def run(arguments: list[str]) -> int:
    """Sweeps as the arguments say; returns the exit code."""
    asked = parse(Arguments, COMMAND, arguments)
    with refusing():
        study = _read(asked.study)
        for name in study:
            if name not in _PARTS:
                raise ValueError(f"{asked.study} has no use for {name!r}; there are {', '.join(_PARTS)}")
        store = asked.store or asked.study.parent / study.get("store", asked.study.with_suffix(".db").name)
        grid = _grid(study)
        config = study.get("config", {})
        # tqdm tells rate and time left.
        seeds = study.get("seeds", 100)
        with ProgressBar(len(grid) * _count(seeds), "run", None, asked.study.stem) as shown:

            def show(progress: SweepProgress) -> None:
                shown.move_to(progress.runs)

            env, block = study.get("env", "MountainCar-v0"), study.get("block", 100)
            options = {"store": store, "threads": asked.threads, "block": block, "callback": show}
            result = sweep(env, grid, seeds, **options, **config)
    print_above(f"{len(result)} runs of {len(result.settings)} settings in {store}, {result.failed} failed")
    return 0


def _read(path: Path) -> dict[str, Any]:
    with path.open("rb") as file:
        try:
            return tomllib.load(file)
        except ValueError as error:
            raise ValueError(f"study must be a TOML file, got {str(path)!r}: {error}") from None


def _count(seeds: Any) -> int:
    return len(seeds) if isinstance(seeds, list) else seeds if isinstance(seeds, int) else 1


def _grid(study: Mapping[str, Any]) -> list[dict[str, Any]]:
    if ("grid" in study) == ("design" in study):
        raise UsageError("the study must have either a [grid] or a [design]")
    if "grid" in study:
        return designs.grid(
            {name: [_tuple(value) for value in _list(name, row)] for name, row in study["grid"].items()}
        )
    design = dict(study["design"])
    kind = design.pop("kind", "sobol")
    if kind not in ("random", "sobol") or not design.keys() <= {"points", "seed", "space"} or "points" not in design:
        raise UsageError("[design] must have kind = 'random' or 'sobol', points, space, and at most a seed")
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
    """``{low = 0.01, high = 1.0, log = true}`` or a list of choices."""
    if not isinstance(axis, dict):
        return axis
    bounds = (axis.get("low"), axis.get("high"))
    return (*bounds, "log") if axis.get("log") else bounds

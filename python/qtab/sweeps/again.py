"""A run of a sweep, trained again."""

from typing import TYPE_CHECKING, Any

import numpy as np

from qtab._utils import checks
from qtab._utils.versions import versions
from qtab.results.run import Run
from qtab.results.summary import summarize
from qtab.sweeps.confirm import plan_again
from qtab.training.resolve import resolve
from qtab.training.train import train_resolved

if TYPE_CHECKING:
    from qtab.sweeps.results import Sweep


def trained_again(sweep: "Sweep", setting: int, seed: int, env: Any) -> Run:
    """Trains a run of a sweep again; see :meth:`qtab.Sweep.run`.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, a run that failed or is not finished, or one that gives other results
            here.
    """
    rows, seed = sweep.rows(setting), checks.integer("seed", seed, least=0)
    found = [int(row) for row in rows if int(sweep.columns["seed"][row]) == seed]
    if not found:
        raise ValueError(f"seed must be that of a finished run of setting {setting}, got {seed}")
    if (error := sweep.columns["error"][found[0]]) is not None:
        raise ValueError(f"the run of setting {setting} with seed {seed} failed: {error}")
    study = plan_again(sweep, [int(setting)], (seed,), env)
    made = study.env() if callable(study.env) else study.env
    resolved = resolve(made, {**study.overrides[0], "seed": seed}, owns_env=True)
    try:
        run = train_resolved(resolved)
    finally:
        resolved.close()
    columns = summarize(run.episode_returns[np.newaxis], run.episode_lengths[np.newaxis], run.terminated[np.newaxis])
    for name, values in columns.items():
        here, there = float(values[0]), float(sweep.columns[name][found[0]])
        if here != there:
            raise ValueError(
                f"the run of setting {setting} with seed {seed} is different here: {name} is {here}, "
                f"in the sweep {there}{_other_versions(sweep, found[0])}"
            )
    return run


def _other_versions(sweep: "Sweep", row: int) -> str:
    """What differs between the versions that trained a run of a sweep and those here, to follow a message."""
    then, here = sweep.run_versions[row] if sweep.run_versions else None, versions()
    others = [f"{name} {then.get(name)}" for name in here if then.get(name) != here[name]] if then else []
    return f", which was trained with {', '.join(others)}" if others else ""

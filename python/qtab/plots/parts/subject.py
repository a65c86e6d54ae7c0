"""The subject of a picture in one form: a run, the mean of several, or an optimum."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from qtab._utils.checks import load_hint
from qtab._utils.shown import shown
from qtab.config import Config
from qtab.config.choices import ALGORITHM_NAMES
from qtab.config.options import PREFERENCES, WITH_STATE_VALUES
from qtab.discretizers import Discretizer
from qtab.discretizers.edges import Edges
from qtab.envs.actions import Actions
from qtab.envs.metadata.quantities import Quantities, quantities_of, tabulated_quantities
from qtab.envs.registry import TABULATED
from qtab.planning.optimum import Optimum
from qtab.results.action_values import read_by_policy, weighted_sum
from qtab.results.axes import Axis, action_names, axes_of, run_quantities
from qtab.results.run import Run
from qtab.results.runs import Runs
from qtab.results.time_steps import at_step, checked_step

Drawable = Run | Runs | Optimum
"""The objects that the pictures show."""

Learned = Literal["action values", "state values", "preferences"]
"""The kinds of values of a state in a picture: of its greedy action, a learned state value, or a preference."""


@dataclass(frozen=True, eq=False)
class Subject:
    """One or several Q tables of one environment."""

    source: Any
    """The object that it was made from."""
    env: str
    """The environment's id, or the name of its class."""
    env_kwargs: Mapping[str, Any]
    """Keyword arguments of the environment's constructor."""
    quantities: Quantities
    """The names and units of its observations and actions."""
    name: str
    """The default title."""
    discretizer: Discretizer
    """Maps observations to rows of the tables."""
    tables: NDArray[np.float64]
    """(seeds, rows, actions): the policy's tables: action values on the scale of returns, or preferences."""
    known: NDArray[np.bool_] | None
    """(seeds, rows): whether anything was learned in the row; None if every value has a meaning."""
    action_names: tuple[str, ...]
    """(actions,): the names of the actions."""
    discount: float
    """The discount of the values."""
    learned: Learned = "action values"
    """The kind of values that :meth:`state_values` returns."""
    state_table: NDArray[np.float64] | None = None
    """(seeds, rows, 1): the state values that were learned with preferences; None for other methods."""

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The components of the observation."""
        return axes_of(self.quantities, self.discretizer)

    def action_values(self, rows: NDArray[Any]) -> NDArray[np.float64]:
        """Returns (seeds, ny, nx, actions) values; NaN where there is no state, or nothing was learned.

        Args:
            rows: (ny, nx, n_active): the active rows at each point of a picture, -1 where there is no state; or the
                values of weighted features.
        """
        return self._read(self.tables, rows)

    def _read(self, tables: NDArray[np.float64], rows: NDArray[Any]) -> NDArray[np.float64]:
        if self.discretizer.is_weighted:
            return np.stack([weighted_sum(rows, table) for table in tables])
        points = rows.reshape(-1, rows.shape[-1])
        first, *others = np.ascontiguousarray(points.T)
        total = np.empty((len(tables), len(points), tables.shape[-1]))
        part = np.empty(total.shape[1:])
        for seed, table in enumerate(tables):
            np.take(table, first, axis=0, out=total[seed], mode="wrap")
            for active in others:
                # Reuses one array: a new one for each tiling would take several times as long.
                total[seed] += np.take(table, active, axis=0, out=part, mode="wrap")
            if self.known is not None:
                # If most tiles of a point were never updated, its value is mostly initial_q.
                total[seed, 2 * np.count_nonzero(self.known[seed][points], axis=-1) < points.shape[-1]] = np.nan
        total[:, first < 0] = np.nan
        return total.reshape(len(total), *rows.shape[:2], -1)

    def state_values(self, rows: NDArray[Any]) -> NDArray[np.float64]:
        """Returns (ny, nx): the learned state value, or else the largest action value or preference.

        It is the mean over the seeds; NaN if no seed has learned it.
        """
        largest = self._read(self.tables if self.state_table is None else self.state_table, rows).max(axis=-1)
        count = (~np.isnan(largest)).sum(axis=0)
        total = np.nansum(largest, axis=0)
        mean: NDArray[np.float64] = np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)
        return mean

    def greedy_actions(self, rows: NDArray[Any]) -> NDArray[np.int64]:
        """Returns (ny, nx): the greedy action, for several seeds the most frequent one; -1 where none is known."""
        values = self.action_values(rows)
        unknown = np.isnan(values).any(axis=-1)
        greedy = np.argmax(np.nan_to_num(values, nan=-np.inf), axis=-1)
        votes = np.array([((greedy == action) & ~unknown).sum(axis=0) for action in range(values.shape[-1])])
        chosen: NDArray[np.int64] = np.where(votes.any(axis=0), votes.argmax(axis=0), -1)
        return chosen


def subject_of(name: str, source: Any, step: Any = 0) -> Subject:
    """Returns the subject of a run, of many runs or of an optimum.

    Args:
        name: The argument that gives it, for messages.
        source: The object to draw.
        step: The step of the episode to show, for runs with ``time_aware=True``.

    Raises:
        TypeError: for anything else.
        ValueError: for runs whose tables were not kept, or a step that does not exist.
    """
    if isinstance(source, Run | Runs) and source.config.time_aware:
        known: Any = source  # one run or many
        subject = subject_of(name, at_step(known, step))
        return replace(subject, name=f"{subject.name}, step {step}")
    checked_step(None, step)
    if isinstance(source, Run):
        return _of_runs(
            source,
            source.config,
            source.tables[np.newaxis],
            source.action_names,
            f"seed {source.config.seed}",
        )
    if isinstance(source, Runs):
        if source.tables is None:
            raise ValueError(f"{name} must hold tables: train_many(..., tables=True) keeps them")
        if not len(source):
            raise ValueError(f"{name} must hold at least one run, got none")
        names = action_names(run_quantities(source.config, source.discretizer), source.actions)
        return _of_runs(source, source.config, source.tables, names, f"{len(source):,} seeds")
    if isinstance(source, Optimum):
        return _of_optimum(source)
    if isinstance(source, Subject):
        return source
    raise TypeError(f"{name} must be a Run, Runs or an Optimum, got {shown(source)}{load_hint(source)}")


def _of_runs(
    source: Run | Runs, config: Config, tables: NDArray[np.float64], names: tuple[str, ...], which: str
) -> Subject:
    # (k, seeds, rows, actions): two tables of action values are on the scale of returns as their mean.
    read = read_by_policy(config, np.moveaxis(tables, 1, 0))
    summed = read[0] if len(read) == 1 else (read[0] + read[1]) / 2
    with_state_values = config.algorithm in WITH_STATE_VALUES
    learned: Learned = "preferences" if config.algorithm in PREFERENCES else "action values"
    if source.action_masks is not None:
        summed = np.where(source.action_masks.reshape(summed.shape), summed, -np.inf)
    return Subject(
        source,
        config.env,
        config.env_kwargs,
        run_quantities(config, source.discretizer),
        f"{config.env}: {ALGORITHM_NAMES[config.algorithm]}, {which}",
        source.discretizer,
        summed,
        _known(source, config, tables),
        names,
        config.discount,
        "state values" if with_state_values else learned,
        tables[:, 1, :, :1] if with_state_values else None,
    )


def _known(source: Run | Runs, config: Config, tables: NDArray[np.float64]) -> NDArray[np.bool_] | None:
    """Returns whether each row was updated: by its visits, or else by a value other than the initial one."""
    if isinstance(source, Run) and source.visits is not None:
        visited: NDArray[np.bool_] = source.visits.reshape(1, -1, source.visits.shape[-1]) > 0
        return np.asarray(visited.any(axis=-1))
    if not isinstance(config.initial_q, int | float):
        return None
    initial = np.full(tables.shape[1], config.initial_q)
    if config.algorithm in WITH_STATE_VALUES:
        initial[1] = 0.0
    changed: NDArray[np.bool_] = (tables != initial[:, np.newaxis, np.newaxis]).any(axis=(1, 3))
    return changed


def _of_optimum(best: Optimum) -> Subject:
    discretizer: Discretizer
    actions = Actions(best.q_values.shape[-1])
    if best.search is not None:
        points = best.search.axes
        components = best.solver.observation_shape[0]
        if len(points) != components:
            raise ValueError(
                f"optimum must have values over the {components} components of an observation, got {best.env}'s over "
                f"the {len(points)} components of its state: see optimum.search.axes"
            )
        low, high = (np.array([axis[end] for axis in points], np.float64) for end in (0, -1))
        discretizer = Edges(low, high, tuple((axis[1:] + axis[:-1]) / 2 for axis in points))
    else:
        solver: Any = best.solver  # of a transition table
        discretizer, actions = solver.cells, solver.actions
    tables = best.q_values.reshape(1, -1, len(actions))
    environment = best.environment
    is_table = environment is not None and environment.cls == TABULATED
    quantities = tabulated_quantities(environment.attributes) if environment and is_table else quantities_of(best.env)
    names = action_names(quantities, actions)
    name = f"{best.env}: {best.label}"
    return Subject(best, best.env, best.env_kwargs, quantities, name, discretizer, tables, None, names, best.discount)

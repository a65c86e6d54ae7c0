"""Watches the updates of policy gradient methods: what an action was worth, and how the preferences changed."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.options import WITH_STATE_VALUES
from qtab.explanation.equations import gain
from qtab.explanation.largest_traces import changed, largest_traces
from qtab.explanation.policy_update import PolicyUpdate, equations_of
from qtab.explanation.records import Trace
from qtab.explanation.updates import Target, total
from qtab.reference.action_masks import ActionMasks
from qtab.reference.policies import Policy
from qtab.reference.task import value, values

Table = NDArray[np.float64]
Cell = tuple[int, ...] | None


@dataclass(frozen=True)
class _Advantage:
    step: int
    reward: float | None
    """None where the target is a return."""
    following: float | None
    target: float
    reference: float
    power: float
    value: float | None


@dataclass(frozen=True)
class _Begun:
    rows: tuple[int, ...]
    action: int
    step_size: float
    gradient: tuple[float, ...]
    traces: tuple[tuple[float, ...], ...]
    largest: tuple[Trace, ...]
    n_traces: int
    before: tuple[tuple[float, ...], ...]
    probabilities: tuple[float, ...]


class PolicyWatcher:
    """Makes a :class:`PolicyUpdate` from what an update shows at its beginning and at its end."""

    def __init__(self, config: Config, cell: Callable[[int], Cell]) -> None:
        self.config, self.cell = config, cell
        self.policy: Policy
        self.masks: ActionMasks
        self._advantage: _Advantage
        self._begun: _Begun

    def advantage(
        self,
        reported: Target,
        tables: Sequence[Table],
        state: Sequence[int],
        target: float,
        reference: float,
        power: float,
    ) -> None:
        """Keeps what an action was worth."""
        known = value(tables[1], list(state), 0) if self.config.algorithm in WITH_STATE_VALUES else None
        assert reported.step is not None  # noqa: S101 - no policy gradient method plans
        reward = reported.rewards[0] if reported.rewards else None
        self._advantage = _Advantage(reported.step, reward, reported.following, target, reference, power, known)

    def begin(
        self,
        H: Table,  # noqa: N803 - the book's name
        state: Sequence[int],
        action: int,
        step_size: float,
        gradient: Sequence[float],
        z: Table | None,
    ) -> None:
        """Keeps the preferences before the update."""
        rows = tuple(state)
        largest, n_traces = ((), 0) if z is None else largest_traces(z, H, self.cell)
        self._begun = _Begun(
            rows,
            action,
            step_size,
            tuple(gradient),
            () if z is None else _rows(z, rows),
            largest,
            n_traces,
            _rows(H, rows),
            self._probabilities(H, rows),
        )

    def end(self, tables: Sequence[Table]) -> tuple[PolicyUpdate, tuple[Trace, ...], int]:
        """Returns the update, the largest traces with what they changed, and the number of traces."""
        worth, begun, H = self._advantage, self._begun, tables[0]  # noqa: N806 - the book's name
        error = worth.target - worth.reference
        after = _rows(H, begun.rows)
        if begun.traces:
            # A preference changes once, however often its row is active.
            alpha = begun.step_size * len(begun.rows)
            direction = sum(row[begun.action] for row in begun.traces) / len(begun.traces)
        else:
            alpha = gain(begun.rows, (begun.step_size,) * len(begun.rows), ())
            direction = begun.gradient[begun.action]
        preferences = [total(tuple(row[begun.action] for row in one)) for one in (begun.before, after)]
        lines = equations_of(
            self.config,
            (worth.reward, worth.following, worth.target, worth.reference, error),
            worth.step,
            alpha,
            direction,
            (preferences[0], preferences[1]),
        )
        known = None
        if worth.value is not None:
            known = value(tables[1], list(begun.rows), 0)
        update = PolicyUpdate(
            step=worth.step,
            rows=begun.rows,
            cell=self.cell(begun.rows[0]),
            action=begun.action,
            reward=worth.reward,
            bootstrap=worth.following,
            target=worth.target,
            reference=worth.reference,
            error=error,
            power=worth.power,
            step_size=begun.step_size,
            gradient=begun.gradient,
            traces=begun.traces,
            before=begun.before,
            after=after,
            probabilities_before=begun.probabilities,
            probabilities_after=self._probabilities(H, begun.rows),
            value_before=worth.value,
            value_after=known,
            equations=tuple(symbols for symbols, _ in lines),
            numbers=tuple(numbers for _, numbers in lines),
        )
        return update, changed(begun.largest, H), begun.n_traces

    def _probabilities(self, H: Table, rows: Sequence[int]) -> tuple[float, ...]:  # noqa: N803
        state = list(rows)
        return tuple(map(float, self.policy.probabilities(self.masks.masked(state, values(H, state)), state)))


def _rows(table: Table, rows: Sequence[int]) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(table[row].tolist()) for row in rows)

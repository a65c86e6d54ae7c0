"""Records the updates of policy gradient methods: the error of an action, and the change of the preferences."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.options import WITH_STATE_VALUES
from qtab.explanation.largest_traces import changed, largest_traces
from qtab.explanation.policy_update import PolicyUpdate, equations_of
from qtab.explanation.records import Trace
from qtab.explanation.updates import Target
from qtab.reference.parts.actions import ActionMasks
from qtab.reference.parts.policies import Policy
from qtab.reference.parts.task import value, values

Table = NDArray[np.float64]
Cell = tuple[int, ...] | None


class PolicyWatcher:
    """Makes a :class:`PolicyUpdate` from the values at the beginning and at the end of an update."""

    def __init__(self, config: Config, cell: Callable[[int], Cell]) -> None:
        self.config, self.cell = config, cell
        self.policy: Policy
        self.masks: ActionMasks
        self._worth: dict[str, Any] = {}
        """The reward, target and error of the next update, by the names of the fields of PolicyUpdate."""
        self._begun: PolicyUpdate
        self._largest: tuple[tuple[Trace, ...], int]
        """The largest traces, and the number of all traces."""

    def advantage(
        self,
        reported: Target,
        tables: Sequence[Table],
        state: Sequence[int],
        target: float,
        reference: float,
        power: float,
    ) -> None:
        """Keeps the target and the reference of an action, and their difference."""
        known = value(tables[1], list(state), 0) if self.config.algorithm in WITH_STATE_VALUES else None
        assert reported.step is not None  # noqa: S101 - no policy gradient method plans
        reward = reported.rewards[0] if reported.rewards else None
        self._worth = {
            "step": reported.step,
            "reward": reward,
            "bootstrap": reported.following,
            "target": target,
            "reference": reference,
            "error": target - reference,
            "power": power,
            "value_before": known,
        }

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
        self._largest = ((), 0) if z is None else largest_traces(z, H, self.cell)
        self._begun = PolicyUpdate(
            **self._worth,
            rows=rows,
            cell=self.cell(rows[0]),
            action=action,
            step_size=step_size,
            gradient=tuple(gradient),
            traces=() if z is None else _rows(z, rows),
            before=_rows(H, rows),
            probabilities_before=self._probabilities(H, rows),
            after=(),
            probabilities_after=(),
            value_after=None,
            equations=(),
            numbers=(),
        )

    def end(self, tables: Sequence[Table]) -> tuple[PolicyUpdate, tuple[Trace, ...], int]:
        """Returns the update, the largest traces with the values that they changed, and the number of traces."""
        begun, preferences = self._begun, tables[0]
        update = replace(
            begun,
            after=_rows(preferences, begun.rows),
            probabilities_after=self._probabilities(preferences, begun.rows),
            value_after=None if begun.value_before is None else value(tables[1], list(begun.rows), 0),
        )
        lines = equations_of(self.config, update)
        symbols, numbers = (tuple(texts) for texts in zip(*lines, strict=True))
        largest, n_traces = self._largest
        return replace(update, equations=symbols, numbers=numbers), changed(largest, preferences), n_traces

    def _probabilities(self, H: Table, rows: Sequence[int]) -> tuple[float, ...]:  # noqa: N803
        state = list(rows)
        return tuple(map(float, self.policy.probabilities(self.masks.masked(state, values(H, state)), state)))


def _rows(table: Table, rows: Sequence[int]) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(table[row].tolist()) for row in rows)

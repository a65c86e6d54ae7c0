"""Records the choices and updates of a reference learner in one episode."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.options import MONTE_CARLO, WITH_STATE_VALUES
from qtab.explanation import policy_update, updates
from qtab.explanation.choices import ObservedPolicy, ObservedStream, explained, exploring_start
from qtab.explanation.equations import total
from qtab.explanation.fast_forward import Start
from qtab.explanation.policy_update import PolicyUpdate
from qtab.explanation.records import Choice, Trace, Update
from qtab.explanation.updates import changed, largest_traces
from qtab.reference.parts.actions import ActionMasks
from qtab.reference.parts.observer import Observer
from qtab.reference.parts.policies import Policy
from qtab.reference.parts.schedules import LearningRate, Schedule
from qtab.reference.parts.streams import AgentStream
from qtab.reference.parts.task import Rows, value, values
from qtab.reference.parts.weighted import WeightedRows

Table = NDArray[np.float64]
Cell = tuple[int, ...] | None


@dataclass
class SeenStep:
    """The events of a step."""

    observation: Any
    rows: tuple[int, ...]
    reward: float
    next_observation: Any
    next_rows: tuple[int, ...]
    terminated: bool
    truncated: bool
    bonus: float = 0.0
    """The bonus that the learner added to the reward."""
    terminal: bool = False
    """Whether the learner treated the next state as terminal, so that its value is zero."""
    updates: list[Update] = field(default_factory=list)
    policy_updates: list[PolicyUpdate] = field(default_factory=list)
    planning: list[Update] = field(default_factory=list)
    traces: tuple[Trace, ...] = ()
    n_traces: int = 0
    future_return: float | None = None
    features: tuple[float, ...] = ()
    next_features: tuple[float, ...] = ()


class Watcher(Observer):
    """Records the steps of one episode, while ``active``; nothing of the episodes before it."""

    def __init__(self, config: Config, cell: Callable[[int], Cell], start: Start | None = None) -> None:
        """Takes the config of the run, a function from a row to its cell, and the episode to start from, if any."""
        self.config, self.cell, self.start = config, cell, start
        self.active = False
        self.tables: list[Table] = []
        self.choices: list[Choice] = []
        self.steps: list[SeenStep] = []
        self._masks: ActionMasks
        self._stream: ObservedStream
        self._policy: Policy
        self._draws: list[float] = []
        self._target: dict[str, Any] | None = None
        """The terms of the target of the next update, by the names of the fields of Update."""
        self._average_reward: float | None = None
        self._update: Update
        self._before_the_first: list[Update] = []
        self._advantage: dict[str, Any] = {}
        """The target and the error of the next policy update, by the names of the fields of PolicyUpdate."""
        self._policy_update: PolicyUpdate
        self._state: Rows

    def masks(self, masks: ActionMasks) -> None:
        """Keeps the action masks, which are filled in as states are seen."""
        self._masks = masks

    def stream(self, stream: AgentStream) -> AgentStream:
        """Returns a stream that records its last random number."""
        self._stream = ObservedStream(stream, self._draws)
        return self._stream

    def policy(self, policy: Policy) -> Policy:
        """Returns a policy that records its choices."""
        self._policy = policy
        self._skip(policy)
        return ObservedPolicy(policy, self._chose)

    def learning_rate(self, rate: LearningRate) -> None:
        """Lowers the rate to that of the episode to start from."""
        self._skip(rate.schedule)

    def table(self, Q: Table) -> None:  # noqa: N803 - the book's name
        """Keeps the table, which the learner changes in place."""
        self.tables.append(Q)
        if self.start is not None:
            Q[:] = self.start.tables[len(self.tables) - 1]

    def begin(self) -> None:
        """Begins the episode to watch."""
        self.active = True
        if self.start is not None:
            self._stream.draw_from(self.start.stream)

    def record(self, step: SeenStep) -> None:
        """Receives a step of the environment, before the learner learns from it."""
        self.steps.append(step)
        step.updates += self._before_the_first
        self._before_the_first.clear()

    def stepped(self, bonus: float, terminal: bool) -> None:
        """Keeps the bonus of the step, and whether the learner treats its next state as terminal."""
        if self.active:
            self.steps[-1].bonus, self.steps[-1].terminal = bonus, terminal

    def target(self, step: int | None, rewards: Sequence[float], following: float | None) -> None:
        """Keeps the terms of the target of the next update."""
        self._target = {"step": step, "rewards": tuple(rewards), "bootstrap": following}

    def returned(self, step: int, target: float) -> None:
        """Keeps the return of a step."""
        if self.active:
            self.steps[step].future_return = target

    def average_reward(self, average: float) -> None:
        """Keeps the average reward in the target of the next update."""
        self._average_reward = average

    def exploring_start(self, values: Table, action: int, valid: int) -> None:
        """Records a first action that no policy chose."""
        if self.active:
            self.choices.append(exploring_start(self._policy, values, action, valid))

    def advantage(self, state: Rows, target: float, reference: float, power: float) -> None:
        """Keeps the target and the reference of an action, and their difference."""
        if self.active:
            reported = self._reported()
            rewards = reported.pop("rewards")
            self._advantage = {
                **reported,
                "reward": rewards[0] if rewards else None,
                "target": target,
                "reference": reference,
                "error": target - reference,
                "power": power,
                "value_before": self._state_value(state),
            }

    def before_ascent(
        self,
        H: Table,  # noqa: N803 - the book's name
        state: Rows,
        action: int,
        step_sizes: Sequence[float],
        gradient: Sequence[float],
        z: Table | None,
    ) -> None:
        """Begins an update of preferences."""
        if not self.active:
            return
        self._state, rows = state, tuple(state)
        self._policy_update = PolicyUpdate(
            **self._advantage,
            rows=rows,
            cell=self.cell(rows[0]),
            action=action,
            step_size=step_sizes[0],
            gradient=tuple(gradient),
            traces=() if z is None else _rows(z, rows),
            before=_rows(H, rows),
            probabilities_before=self._probabilities(H, state),
            after=(),
            probabilities_after=(),
            value_after=None,
            equations=(),
            numbers=(),
            step_sizes=tuple(step_sizes),
            features=_features(state),
        )
        if z is not None:
            seen = self.steps[self._policy_update.step]
            seen.traces, seen.n_traces = largest_traces(z, H, self.cell)

    def after_ascent(self, H: Table) -> None:  # noqa: N803
        """Ends the update of preferences."""
        if self.active:
            rows, seen = self._policy_update.rows, self.steps[self._policy_update.step]
            update = replace(
                self._policy_update,
                after=_rows(H, rows),
                probabilities_after=self._probabilities(H, self._state),
                value_after=self._state_value(self._state),
            )
            symbols, numbers = zip(*policy_update.equations_of(self.config, update), strict=True)
            seen.policy_updates.append(replace(update, equations=symbols, numbers=numbers))
            seen.traces = changed(seen.traces, H)

    def before_update(self, Q: Table, state: Rows, action: int, target: float) -> None:  # noqa: N803
        """Begins an update: of this step, of an earlier one for n-step methods, or in planning."""
        if self.active:
            weights = tuple(Q[list(state), action].tolist())
            before = total(weights, _features(state))
            self._update = Update(
                **self._reported(),
                table=next(index for index, known in enumerate(self.tables) if known is Q),
                rows=tuple(state),
                cell=self.cell(state[0]),
                action=action,
                target=target,
                error=target - before,
                average_reward=self._average_reward,
                before=before,
                weights_before=weights,
                step_sizes=(),
                traces=(),
                old_value=None,
                after=before,
                weights_after=weights,
                equations=(),
                numbers=(),
                features=_features(state),
            )

    def traces(self, z: Table, old_value: float | None = None) -> None:
        """Keeps the traces that the update begun last applies: those of S and A, and the largest ones of all."""
        if self.active:
            begun, seen = self._update, self.steps[-1]
            own = tuple(z[list(begun.rows), begun.action].tolist())
            self._update = replace(begun, traces=own, old_value=old_value)
            seen.traces, seen.n_traces = largest_traces(z, self.tables[0], self.cell)

    def after_update(self, Q: Table, step_sizes: Sequence[float] | None) -> None:  # noqa: N803
        """Ends the update."""
        if not self.active:
            return
        begun, seen = self._update, self.steps[-1] if self.steps else None
        weights = tuple(Q[list(begun.rows), begun.action].tolist())
        after = total(weights, begun.features)
        update = replace(begun, step_sizes=tuple(step_sizes or ()), after=after, weights_after=weights)
        symbols, numbers = zip(*updates.equations_of(self.config, update), strict=True)
        update = replace(update, equations=symbols, numbers=numbers)
        if seen is None:
            self._before_the_first.append(update)
        elif update.step is None:
            seen.planning.append(update)
        else:
            by_episode = self.config.algorithm in MONTE_CARLO
            self.steps[update.step if by_episode else -1].updates.append(update)
            seen.traces = changed(seen.traces, Q)

    def _reported(self) -> dict[str, Any]:
        """Returns the target that the learner reported for this update, and removes it."""
        reported, self._target = self._target, None
        if reported is None:
            raise AssertionError(f"{self.config.algorithm} did not report the target of an update")
        return reported

    def _skip(self, schedule: Policy | Schedule) -> None:
        for _ in range(0 if self.start is None else self.start.episode):
            schedule.end_episode()

    def _chose(self, values: NDArray[np.float64], state: list[int], bounds: list[float], action: int) -> None:
        if self.active:
            drawn = self._draws[0] if self._draws else float("nan")
            self.choices.append(explained(self._policy, values, state, bounds, action, drawn))

    def _probabilities(self, H: Table, state: Rows) -> tuple[float, ...]:  # noqa: N803
        return tuple(map(float, self._policy.probabilities(self._masks.masked(state, values(H, state)), state)))

    def _state_value(self, state: Rows) -> float | None:
        return value(self.tables[1], state, 0) if self.config.algorithm in WITH_STATE_VALUES else None


def _features(state: Rows) -> tuple[float, ...]:
    """Returns the features of a state; none if each is 1."""
    return tuple(state.x) if isinstance(state, WeightedRows) else ()


def _rows(table: Table, rows: Sequence[int]) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(table[row].tolist()) for row in rows)

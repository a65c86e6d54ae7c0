"""Watches a reference learner: the choices and updates of one episode."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.config.options import MONTE_CARLO
from qtab.explanation.choices import ObservedPolicy, ObservedStream, explained, exploring_start
from qtab.explanation.fast_forward import Start
from qtab.explanation.policy_update import PolicyUpdate
from qtab.explanation.policy_watcher import SHOWN_TRACES, PolicyWatcher
from qtab.explanation.records import Choice, Trace, Update
from qtab.explanation.targets import bootstrap, discounted
from qtab.explanation.updates import UnfinishedUpdate, finish_update
from qtab.reference.action_masks import ActionMasks
from qtab.reference.observer import Observer
from qtab.reference.policies import Policy
from qtab.reference.schedules import LearningRate, Schedule
from qtab.reference.streams import AgentStream

Table = NDArray[np.float64]
Cell = tuple[int, ...] | None


@dataclass
class SeenStep:
    """What happened in a step."""

    observation: Any
    rows: tuple[int, ...]
    reward: float
    next_observation: Any
    next_rows: tuple[int, ...]
    terminated: bool
    truncated: bool
    terminal: bool
    """Whether the learner takes the next state as terminal, so that its value is zero."""
    updates: list[Update] = field(default_factory=list)
    policy_updates: list[PolicyUpdate] = field(default_factory=list)
    planning: list[Update] = field(default_factory=list)
    traces: tuple[Trace, ...] = ()
    n_traces: int = 0
    future_return: float | None = None


class Watcher(Observer):
    """Records the steps of one episode, while ``active``; nothing of the episodes before it."""

    def __init__(self, config: Config, cell: Callable[[int], Cell], start: Start | None = None) -> None:
        """Takes the config of the run, a function from a row to its cell, and the episode to start from, if any."""
        self.config, self.cell, self.start = config, cell, start
        self.active = False
        self.tables: list[Table] = []
        self.choices: list[Choice] = []
        self.steps: list[SeenStep] = []
        self._stream: ObservedStream
        self._policy: Policy | None = None
        self._masks: ActionMasks
        self._unfinished: UnfinishedUpdate | None = None
        self._draws: list[float] = []
        self._given: tuple[int, tuple[float, ...], float | None] | None = None
        self._average_reward: float | None = None
        self._before_the_first: list[Update] = []
        self._policy_watcher = PolicyWatcher(config, cell)

    def masks(self, masks: ActionMasks) -> None:
        """Keeps the action masks, which are filled in as states are seen."""
        self._masks = self._policy_watcher.masks = masks

    def stream(self, stream: AgentStream) -> AgentStream:
        """Returns a stream that keeps the last number that decided."""
        self._stream = ObservedStream(stream, self._draws)
        return self._stream

    def policy(self, policy: Policy) -> Policy:
        """Returns a policy that keeps what it chooses."""
        self._policy = self._policy_watcher.policy = policy
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
        self.finish()
        self.steps.append(step)
        step.updates += self._before_the_first
        self._before_the_first.clear()

    def target(self, step: int, reward: float, following: float | None) -> None:
        """Keeps what the target of the next update is made of."""
        self._given = step, (reward,), following

    def returned(self, step: int, target: float) -> None:
        """Keeps the return of a step."""
        if self.active:
            self.steps[step].future_return = target

    def average_reward(self, average: float) -> None:
        """Keeps the average reward in the target of the next update."""
        self._average_reward = average

    def exploring_start(self, values: Table, action: int, valid: int) -> None:
        """Records a first action that no policy chose."""
        if self.active and self._policy is not None:
            self.choices.append(exploring_start(self._policy, values, action, valid))

    def advantage(self, step: int, state: Sequence[int], target: float, reference: float, power: float) -> None:
        """Keeps what an action was worth."""
        if self.active:
            _, rewards, following = self._given or (step, (), None)
            if self.config.algorithm == "gradient_bandit":
                rewards = (target,)
            parts = (rewards[0] if rewards else None, following)
            self._policy_watcher.advantage(step, self.tables, state, parts, target, reference, power)
            self._given = None

    def before_ascent(
        self,
        H: Table,  # noqa: N803 - the book's name
        state: Sequence[int],
        action: int,
        step_size: float,
        gradient: Sequence[float],
        z: Table | None,
    ) -> None:
        """Begins an update of preferences."""
        if self.active:
            self._policy_watcher.begin(H, state, action, step_size, gradient, z)

    def after_ascent(self, H: Table) -> None:  # noqa: N803, ARG002
        """Ends it."""
        if self.active:
            update, traces, n_traces = self._policy_watcher.end(self.tables)
            seen = self.steps[update.step]
            seen.policy_updates.append(update)
            seen.traces, seen.n_traces = traces, n_traces

    def before_update(self, Q: Table, state: Sequence[int], action: int, target: float) -> None:  # noqa: N803
        """Begins an update: of this step, of an earlier one for n-step Sarsa, or in planning."""
        if not self.active:
            return
        table = next(index for index, known in enumerate(self.tables) if known is Q)
        step: int | None
        rewards: tuple[float, ...]
        algorithm = self.config.algorithm
        planned = algorithm in ("dyna_q", "dyna_q_plus") and self.steps[-1].updates
        if planned or algorithm == "prioritized_sweeping":
            step, rewards, following = None, (), None  # planning
        else:
            step, rewards, following = self._given or self._target(table)
            self._given = None
        self._unfinished = UnfinishedUpdate(
            step, table, tuple(state), action, rewards, following, target, self._weights(table, state)
        )
        self._unfinished.average_reward, self._average_reward = self._average_reward, None

    def after_update(self, Q: Table, step_sizes: Sequence[float] | None) -> None:  # noqa: N803, ARG002
        """Ends it."""
        if self._unfinished is not None:
            self._unfinished.step_sizes = tuple(step_sizes or ())
            self._end()

    def before_traces(self, Q: Table, z: Table, error: float, rate: LearningRate) -> None:  # noqa: N803, ARG002
        """Begins an update of all values with a trace. It ends before the next step, or with the episode."""
        if not self.active:
            return
        step, rewards, following = self._target(0)
        seen, action = self.steps[step], self.choices[step].action
        target = discounted(rewards, self.config.discount, following)
        unfinished = UnfinishedUpdate(
            step, 0, seen.rows, action, rewards, following, target, self._weights(0, seen.rows)
        )
        unfinished.step_sizes = tuple(rate.step(row, action) for row in seen.rows)
        unfinished.traces = tuple(float(z[row, action]) for row in seen.rows)
        if self.config.algorithm == "true_online_sarsa_lambda":
            unfinished.old_value = (self.steps[step - 1].updates[0].bootstrap or 0.0) if step > 0 else 0.0
        traced = np.argwhere(z != 0.0)
        order = np.argsort(-np.abs(z[z != 0.0]), kind="stable")[:SHOWN_TRACES]
        seen.n_traces = len(traced)
        seen.traces = tuple(
            Trace(row, self.cell(row), column, float(z[row, column]), float(Q[row, column]), float("nan"))
            for row, column in traced[order].tolist()
        )
        self._unfinished = unfinished

    def finish(self) -> None:
        """Ends the update of the traces, if there is one."""
        if self._unfinished is not None:
            seen, Q = self.steps[-1], self.tables[0]  # noqa: N806
            seen.traces = tuple(
                Trace(one.row, one.cell, one.action, one.trace, one.before, float(Q[one.row, one.action]))
                for one in seen.traces
            )
            self._end()

    def _skip(self, schedule: Policy | Schedule) -> None:
        for _ in range(0 if self.start is None else self.start.episode):
            schedule.end_episode()

    def _chose(self, values: NDArray[np.float64], state: list[int], bounds: list[float], action: int) -> None:
        if self.active and self._policy is not None:
            drawn = self._draws[0] if self._draws else float("nan")
            self.choices.append(explained(self._policy, values, state, bounds, action, drawn))

    def _target(self, table: int) -> tuple[int, tuple[float, ...], float | None]:
        """The step that is updated next, the rewards in its target, and the value of what follows them."""
        if self.config.algorithm == "n_step_sarsa":
            step = sum(len(seen.updates) for seen in self.steps)
            end = min(step + (self.config.n_steps or 1), len(self.steps))
        else:
            step, end = len(self.steps) - 1, len(self.steps)
        rewards = tuple(seen.reward for seen in self.steps[step:end])
        last = self.steps[end - 1]
        if last.terminal:
            return step, rewards, None
        assert self._policy is not None  # noqa: S101 - it is given before the first step
        next_action = self.choices[end].action if len(self.choices) > end else -1
        following = bootstrap(
            self.config.algorithm, self.tables, table, list(last.next_rows), next_action, self._policy, self._masks
        )
        return step, rewards, following

    def _weights(self, table: int, rows: Sequence[int]) -> tuple[tuple[float, ...], ...]:
        return tuple(tuple(self.tables[table][row].tolist()) for row in rows)

    def _end(self) -> None:
        unfinished, self._unfinished = self._unfinished, None
        if unfinished is not None:
            update = finish_update(
                unfinished, self.config, self.cell(unfinished.rows[0]), self._weights(unfinished.table, unfinished.rows)
            )
            if unfinished.step == -1:
                self._before_the_first.append(update)
            elif unfinished.step is None:
                self.steps[-1].planning.append(update)
            else:
                by_episode = self.config.algorithm in MONTE_CARLO
                self.steps[unfinished.step if by_episode else -1].updates.append(update)

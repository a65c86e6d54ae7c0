"""The interface to which learners report their work. :func:`qtab.explain` uses it to follow a run."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from qtab.reference.parts.streams import AgentStream

if TYPE_CHECKING:
    from qtab.reference.parts.actions import ActionMasks
    from qtab.reference.parts.policies import Policy
    from qtab.reference.parts.schedules import LearningRate

Table = NDArray[np.float64]


class Observer:
    """Receives the parts of a task and every update. The base class ignores them."""

    def masks(self, masks: "ActionMasks") -> None:
        """Called with the action masks, which are filled in as states are seen."""

    def stream(self, stream: AgentStream) -> AgentStream:
        """Returns the agent's random numbers, or the same numbers observed."""
        return stream

    def policy(self, policy: "Policy") -> "Policy":
        """Returns the policy, or the same policy observed."""
        return policy

    def learning_rate(self, rate: "LearningRate") -> None:
        """Called with the learning rate of each table before the first episode."""

    def table(self, Q: Table) -> None:
        """Called with each table before the first episode."""

    def stepped(self, bonus: float, terminal: bool) -> None:
        """Called after each step of the environment, before the learner learns from it.

        Args:
            bonus: The count bonus that the learner adds to the reward, or 0.
            terminal: Whether the learner treats the next state as terminal, so that its value is zero.
        """

    def target(self, step: int | None, rewards: Sequence[float], following: float | None) -> None:
        """Called before every update, with the terms of its target.

        Args:
            step: The number of the step in the episode, from 0; -1 is the last one of the previous episode, and None a
                planned one.
            rewards: The rewards in the target, with their bonuses, of which the k-th is discounted by γ^(k-1); empty
                if the target is a return G.
            following: The discounted value after the rewards; None if nothing follows.
        """

    def returned(self, step: int, target: float) -> None:
        """Called with the return G of each step of an episode that is over."""

    def average_reward(self, average: float) -> None:
        """Called before an update of a differential method with the average reward R̄ in its target."""

    def exploring_start(self, values: Table, action: int, valid: int) -> None:
        """Called with the first action of an episode if it is drawn among all valid actions of the state."""

    def advantage(self, state: list[int], target: float, reference: float, power: float) -> None:
        """Called before a state value and the preferences change.

        Args:
            state: The active rows of the state.
            target: The reward, the return G, or R + γ v(S') of its action.
            reference: The value to compare the target with; 0 without a baseline.
            power: γ^t.
        """

    def before_ascent(
        self,
        H: Table,
        state: list[int],
        action: int,
        step_sizes: Sequence[float],
        gradient: Sequence[float],
        z: Table | None,
    ) -> None:
        """Called before preferences change along the gradient of ln π(A | S), or by their traces."""

    def after_ascent(self, H: Table) -> None:
        """Called after the preferences changed."""

    def before_update(self, Q: Table, state: list[int], action: int, target: float) -> None:
        """Called before Q(S, A) changes towards a target."""

    def after_update(self, Q: Table, step_sizes: Sequence[float] | None) -> None:
        """Called after Q(S, A) changed, with the step size of each active row; None if the target was assigned."""

    def traces(self, z: Table, old_value: float | None = None) -> None:
        """Called in an update before all values with a trace change; ``old_value`` is Q_old of true online Sarsa(λ)."""


_observer: ContextVar[Observer | None] = ContextVar("_observer", default=None)


def current_observer() -> Observer:
    """Returns the observer of the learners that start now."""
    return _observer.get() or Observer()


@contextmanager
def observed_by(observer: Observer) -> Iterator[None]:
    """Lets an observer watch the learners that start inside the context."""
    token = _observer.set(observer)
    try:
        yield
    finally:
        _observer.reset(token)

"""The reasons for a policy's choices: the random numbers that it drew, and the values that it compared."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from qtab.explanation.records import Choice, Reason
from qtab.reference.parts.policies import EpsilonGreedy, Policy, Softmax, Ucb
from qtab.reference.parts.streams import AgentStream


class ObservedStream:
    """An agent's random numbers, with a record of the last float."""

    def __init__(self, stream: AgentStream, kept: list[float]) -> None:
        self._kept = kept
        self.draw_from(stream)

    def draw_from(self, stream: AgentStream) -> None:
        """Draws from another stream from now on."""
        self._stream = stream
        self.integers, self.uniform = stream.integers, stream.uniform

    def random(self) -> float:
        """Returns a float in [0, 1)."""
        drawn = self._stream.random()
        self._kept[:] = [drawn]
        return drawn


class ObservedPolicy:
    """A policy that reports the values and the action of each choice to ``chose``."""

    def __init__(
        self, policy: Policy, chose: Callable[[NDArray[np.float64], list[int], list[float], int], None]
    ) -> None:
        self._policy, self._chose = policy, chose
        self.probabilities, self.end_episode = policy.probabilities, policy.end_episode

    def choose(self, values: NDArray[np.float64], state: list[int]) -> int:
        """Returns an action."""
        # The choice changes the bounds.
        bounds = self._policy.bounds(values, state) if isinstance(self._policy, Ucb) else []
        action = self._policy.choose(values, state)
        self._chose(values, state, bounds, action)
        return action


def exploring_start(policy: Policy, values: NDArray[np.float64], action: int, valid: int) -> Choice:
    """Returns the record of an exploring start: the first action of an episode, drawn among all valid ones."""
    return Choice(
        action=action,
        reason="exploring start",
        values=tuple(values.tolist()),
        probability=1.0 / valid,
        drawn=float("nan"),
        tied=int(np.count_nonzero(values == np.max(values))),
        epsilon=policy.epsilon.value if isinstance(policy, EpsilonGreedy) else None,
        temperature=policy.temperature if isinstance(policy, Softmax) else None,
        random_ties=True,
    )


def explained(
    policy: Policy, values: NDArray[np.float64], state: list[int], bounds: list[float], action: int, drawn: float
) -> Choice:
    """Returns the record of a policy's choice, with its reason.

    Args:
        policy: The policy.
        values: (actions,): the action values.
        state: The active rows of the state.
        bounds: (actions,): the upper confidence bounds that were compared; empty for other policies.
        action: The action.
        drawn: The random number in [0, 1) that the policy drew, if it draws one.
    """
    compared = np.array(bounds) if bounds else values
    tied = int(np.count_nonzero(compared == np.max(compared)))
    reason: Reason = "softmax"
    epsilon = None
    random_ties = isinstance(policy, EpsilonGreedy | Ucb) and policy.random_ties
    if bounds:
        probability = 1.0 / tied if random_ties else 1.0
        return Choice(action, "upper bound", tuple(bounds), probability, float("nan"), tied, None, None, random_ties)
    if isinstance(policy, EpsilonGreedy):
        epsilon = policy.epsilon.value
        reason = "explored" if not drawn < 1.0 - epsilon else "greedy" if tied == 1 else "tie broken"
    return Choice(
        action=action,
        reason=reason,
        values=tuple(values.tolist()),
        probability=float(policy.probabilities(values, state)[action]),
        drawn=drawn,
        tied=tied,
        epsilon=epsilon,
        temperature=policy.temperature if isinstance(policy, Softmax) else None,
        random_ties=random_ties,
    )

"""A walk over all reachable states of an environment, breadth first."""

from collections import deque
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from qtab._utils.progress import ProgressBar
from qtab._utils.shown import counted
from qtab.envs.tabular import Transition
from qtab.envs.tabulation.state_keys import growing_numbers

FEWEST_STEPS = 10_000
"""The shortest episodes whose returns lie above the reward of an unavailable action; without a limit, training ends
episodes there."""


@dataclass(frozen=True, eq=False)
class Visit:
    """A state that was reached."""

    state: Any
    key: Hashable
    """Equal for equal states."""
    observation: Any
    mask: NDArray[np.bool_] | None
    """(actions,): the available actions; None if the environment has no masks, or the state is terminal."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """An outcome of a step."""

    probability: Fraction
    visit: Visit
    """The next state."""
    reward: float
    terminated: bool

    @property
    def identity(self) -> tuple[Hashable, float, bool]:
        """The key of the next state, the reward, and whether the episode ends: equal for equal outcomes."""
        return self.visit.key, self.reward, self.terminated


class Outcomes(Protocol):
    """The outcomes of an environment, listed."""

    name_of_state: str
    """The name of a state in messages."""

    def initial(self) -> list[tuple[Fraction, Visit]]:
        """Returns the first states of an episode with their probabilities."""

    def step(self, state: Any, action: int) -> list[Outcome]:
        """Returns the outcomes of an action."""

    def plain_states(self, states: Sequence[Any]) -> list[Any]:
        """Returns the states as a table keeps them."""

    def check_unchanged(self) -> None:
        """Checks, after the walk, that the environment itself was not changed."""


@dataclass(eq=False)
class Walk:
    """The reachable states of an environment and their transitions.

    Args:
        outcomes: The outcomes of the environment.
        n_actions: The number of actions.
        first_action: The first action.
        max_states: The most states.
    """

    outcomes: Outcomes
    n_actions: int
    first_action: int
    max_states: int
    visits: list[Visit] = field(default_factory=list)
    """The states in the order in which they were found."""
    transitions: dict[int, list[list[Transition] | None]] = field(default_factory=dict)
    """For each state that is not terminal the transitions of each action; None for an unavailable action."""
    _numbers: dict[Hashable, int] = field(default_factory=dict)

    def run(self) -> NDArray[np.float64]:
        """Walks, and returns the probabilities of the first states, (states,).

        Raises:
            ValueError: for more than ``max_states`` states.
        """
        pending: deque[int] = deque()
        first: dict[int, Fraction] = {}
        for probability, visit in self.outcomes.initial():
            number = self._number(visit)
            first[number] = first.get(number, Fraction(0)) + probability
        pending.extend(first)
        queued = set(first)
        with ProgressBar(None, "state", None, "tabulate") as bar:
            while pending:
                number = pending.popleft()
                rows: list[list[Transition] | None] = []
                self.transitions[number] = rows
                visit = self.visits[number]
                for index in range(self.n_actions):
                    if visit.mask is not None and not visit.mask[index]:
                        rows.append(None)
                        continue
                    outcomes = self.outcomes.step(visit.state, self.first_action + index)
                    rows.append(self._merged(outcomes))
                    # A state may be terminal by one transition and not by another.
                    continuing = (self._numbers[one.visit.key] for one in outcomes if not one.terminated)
                    new = [found for found in dict.fromkeys(continuing) if found not in queued]
                    queued.update(new)
                    pending.extend(new)
                bar.move_to(len(self.transitions))
        self.outcomes.check_unchanged()
        distribution = np.zeros(len(self.visits))
        distribution[list(first)] = [float(probability) for probability in first.values()]
        return distribution

    def table(self, max_episode_steps: int | None) -> list[list[list[Transition]]]:
        """Returns the transitions of all states and actions.

        A terminal state stays as it is. An unavailable action ends the episode with a reward below every return within
        the time limit and within 10,000 steps, so that no best policy takes it.

        Args:
            max_episode_steps: The time limit in steps; None without one.
        """
        rewards = (one[2] for rows in self.transitions.values() for row in rows for one in row or ())
        lowest = max(max_episode_steps or 0, FEWEST_STEPS) * min(min(rewards, default=0.0), 0.0) - 1.0
        return [
            [
                [(1.0, number, 0.0, True)] if rows is None else [(1.0, number, lowest, True)] if row is None else row
                for row in (rows or [None] * self.n_actions)
            ]
            for number, rows in ((number, self.transitions.get(number)) for number in range(len(self.visits)))
        ]

    def masks(self) -> NDArray[np.bool_] | None:
        """Returns the masks, (states, actions), without restriction in terminal states; None if there are none."""
        if all(visit.mask is None for visit in self.visits):
            return None
        every = np.ones(self.n_actions, np.bool_)
        return np.array([every if visit.mask is None else visit.mask for visit in self.visits])

    def _merged(self, outcomes: list[Outcome]) -> list[Transition]:
        """Adds the probabilities of equal outcomes. They stay in the order in which each is found first."""
        sums: dict[tuple[int, float, bool], Fraction] = {}
        for one in outcomes:
            found = self._number(one.visit), one.reward, one.terminated
            sums[found] = sums.get(found, Fraction(0)) + one.probability
        return [
            (float(probability), state, reward, terminated) for (state, reward, terminated), probability in sums.items()
        ]

    def _number(self, visit: Visit) -> int:
        number = self._numbers.get(visit.key)
        if number is not None:
            known = self.visits[number]
            if known.mask is None and visit.mask is not None:  # the state was terminal when it was found
                self.visits[number] = visit
            return number
        if len(self.visits) == self.max_states:
            raise self._too_many()
        self._numbers[visit.key] = len(self.visits)
        self.visits.append(visit)
        return len(self.visits) - 1

    def _too_many(self) -> ValueError:
        growing = growing_numbers([visit.state for visit in self.visits], self.outcomes.name_of_state)
        hint = f". These numbers keep growing: {growing}" if growing else ""
        waiting = len(self.visits) - len(self.transitions)
        return ValueError(
            f"env must have at most max_states={self.max_states:,} reachable states, found more after the actions of "
            f"{counted(len(self.transitions), 'state')}, with {waiting:,} still to follow{hint}"
        )

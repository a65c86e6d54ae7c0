"""The Markov reward process of a policy: its transition matrix, its rewards and its state distribution."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from qtab._utils.memory import check_memory

FloatArray = NDArray[np.float64]
MATRICES = 6
"""The number of (states, states) arrays that exact computations need at the same time."""


@dataclass(frozen=True, eq=False)
class Chain:
    """The transitions of all states under a policy; all arrays are (transitions,)."""

    states: int
    """The number of states."""
    state: NDArray[np.int64]
    probability: FloatArray
    """The probability of the action and of the transition."""
    next_state: NDArray[np.int64]
    reward: FloatArray
    continues: NDArray[np.bool_]
    """Whether the episode goes on in the next state, whose value counts."""
    initial: FloatArray
    """(states,): the distribution of the first state of an episode."""

    @cached_property
    def matrix(self) -> FloatArray:
        """(states, states): the probability of each next state; a row sums to less than 1 where episodes may end."""
        matrix = np.zeros((self.states, self.states))
        going = self.continues
        np.add.at(matrix, (self.state[going], self.next_state[going]), self.probability[going])
        return matrix

    @cached_property
    def rewards(self) -> FloatArray:
        """(states,): the expected reward of a step from each state."""
        rewards: FloatArray = np.bincount(self.state, self.probability * self.reward, self.states).astype(np.float64)
        return rewards

    @cached_property
    def distribution(self) -> FloatArray:
        """(states,): the fraction of time steps spent in each state in the long run, with one episode after another.

        It is that of equation 9.3 if episodes end, and the stationary distribution if they never do.

        Raises:
            ValueError: if it depends on the random course of an episode that never ends.
        """
        # The end of an episode leads to the first state of the next one, unless episodes never end.
        ends = np.bincount(self.state, np.where(self.continues, 0.0, self.probability), self.states)
        restarting = self.matrix + ends[:, None] * self.initial
        recurrent = _recurrent_states(restarting, self.initial > 0.0)
        part = restarting[np.ix_(recurrent, recurrent)]
        # μ = μ P and Σ μ = 1: one equation of the first kind follows from the others.
        equations = np.eye(len(part)) - part.T
        equations[-1] = 1.0
        distribution = np.zeros(self.states)
        distribution[recurrent] = np.maximum(np.linalg.solve(equations, np.eye(len(part))[-1]), 0.0)
        distribution /= distribution.sum()
        return distribution


def _recurrent_states(matrix: FloatArray, first: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Returns the states that a chain visits again and again, from given first states.

    Raises:
        ValueError: if there are several sets of such states, so that chance decides between them.
    """
    following = [np.flatnonzero(row) for row in matrix > 0.0]
    preceding = [np.flatnonzero(column) for column in matrix.T > 0.0]
    reached = np.zeros(len(matrix), np.bool_)
    _reach(following, np.flatnonzero(first), reached)
    # A state that all others lead to is recurrent, and so are those that it leads to. Each search finds the states that
    # lead to its first state. If all states lead to some state, they also lead to the first state of the last search.
    found, last = ~reached, 0
    while not found.all():
        last = int(np.flatnonzero(~found)[0])
        _reach(preceding, np.array([last]), found)
    leading, recurrent = np.zeros((2, len(matrix)), np.bool_)
    _reach(preceding, np.array([last]), leading)
    others = np.flatnonzero(reached & ~leading)
    if len(others):
        raise ValueError(
            "distribution must be given for a policy under which some episodes end up in one set of states and some in "
            f"another: no steps lead from state {others[0]} to state {last}"
        )
    _reach(following, np.array([last]), recurrent)
    return np.flatnonzero(recurrent)


def _reach(following: Sequence[NDArray[np.int64]], first: NDArray[np.int64], reached: NDArray[np.bool_]) -> None:
    """Marks the first states and all that they lead to, without going through states that are marked already."""
    reached[first] = True
    waiting = first.tolist()
    while waiting:
        new = following[waiting.pop()]
        new = new[~reached[new]]
        reached[new] = True
        waiting += new.tolist()


def chain_of(
    transitions: Sequence[Sequence[tuple[float, int, float, bool]]], policy: FloatArray, initial: FloatArray
) -> Chain:
    """Returns the Markov reward process of a policy.

    Args:
        transitions: The transitions (probability, next state, reward, terminated) of each action in each state, the
            actions of state 0 first.
        policy: (states, actions): the probabilities of the actions.
        initial: (states,): the distribution of the first state of an episode.

    Raises:
        MemoryError: if matrices of all states would take more than half of the machine's memory, or more than is free.
    """
    states, actions = policy.shape
    check_memory(f"matrices of {states:,} x {states:,} numbers for {states:,} states", 8 * MATRICES * states**2)
    chosen = [
        (pair // actions, weight * probability, next_state, reward, not terminated)
        for pair, weight in enumerate(policy.ravel().tolist())
        if weight > 0.0
        for probability, next_state, reward, terminated in transitions[pair]
        if probability > 0.0
    ]
    state, probability, next_state, reward, continues = zip(*chosen, strict=True)
    return Chain(
        states,
        np.array(state, np.int64),
        np.array(probability),
        np.array(next_state, np.int64),
        np.array(reward, np.float64),
        np.array(continues, np.bool_),
        initial,
    )

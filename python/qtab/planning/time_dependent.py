"""The exact return of a policy that depends on the number of steps taken, from a transition table."""

import numpy as np
from numpy.typing import NDArray

from qtab import _core


def time_dependent_return(planner: _core.MdpSolver, policy: NDArray[np.int64]) -> float:
    """Returns the undiscounted expected return of a policy under a time limit, by backward induction.

    Args:
        planner: The transition table.
        policy: (max_episode_steps, rows): the action after each number of steps, counted from 0, for each observation.

    Raises:
        OverflowError: if it exceeds the range of float64.
        ValueError: if it has no action for each row, or one that does not exist.
    """
    rows, n_actions = planner.rows, planner.n_actions
    if policy.shape[1] <= int(rows.max()) or not ((policy >= 0) & (policy < n_actions)).all():
        raise ValueError("policy must have an action for each row")
    probabilities, states, rewards = _outcomes(planner)
    immediate = (probabilities * rewards[0]).sum(axis=1)
    continues = probabilities * rewards[1]
    pairs = np.arange(len(rows)) * n_actions
    values = np.zeros(len(rows))
    for actions in policy[::-1]:
        chosen = pairs + actions[rows]
        values = immediate[chosen] + (continues[chosen] * values[states[chosen]]).sum(axis=1)
    if not np.isfinite(values).all():
        raise OverflowError("rewards must be smaller here: the return exceeds the range of float64")
    return float(planner.initial_distribution @ values)


def _outcomes(
    planner: _core.MdpSolver,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """The outcomes of each state-action pair as arrays (pairs, outcomes), filled up with probabilities of 0.

    They are the probabilities, the next states, and (2, pairs, outcomes) the rewards and whether the episode continues.
    """
    transitions = planner.transitions()
    most = max(map(len, transitions))
    probabilities, states = np.zeros((len(transitions), most)), np.zeros((len(transitions), most), np.int64)
    rewards = np.zeros((2, len(transitions), most))
    for pair, outcomes in enumerate(transitions):
        for index, (probability, state, reward, terminated) in enumerate(outcomes):
            probabilities[pair, index], states[pair, index] = probability, state
            rewards[:, pair, index] = reward, not terminated
    return probabilities, states, rewards

"""Random Markov decision processes, on which Sutton & Barto compare ways of distributing updates (Figure 8.8)."""

import numpy as np

from qtab._utils import checks
from qtab.envs.tabular import TabularEnv


def random_mdp(
    states: int = 1000, branching: int = 1, seed: int = 0, *, actions: int = 2, termination: float = 0.1
) -> TabularEnv:
    """Returns a random Markov decision process: in each state, each action leads to one of ``branching`` random states.

    These next states are drawn with replacement and are equally likely. The reward of each transition is drawn
    from a normal distribution of mean 0 and variance 1. Every transition ends the episode with a small probability, and
    a reward of 0. An episode starts in state 0.

    Args:
        states: The number of states.
        branching: The number b of transitions of a state and an action.
        seed: The seed of the random numbers.
        actions: The number of actions.
        termination: The probability that a transition ends the episode.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for one out of range.
    """
    states = checks.integer("states", states, least=1)
    branching = checks.integer("branching", branching, least=1)
    actions = checks.integer("actions", actions, least=1)
    termination = checks.real("termination", termination, 0.0, 1.0)
    rng = np.random.default_rng(checks.integer("seed", seed, least=0))
    shape = (states, actions, branching)
    following = rng.integers(states, size=shape).tolist()
    rewards = rng.standard_normal(shape).tolist()
    each = (1.0 - termination) / branching
    ends = [(termination, 0, 0.0, True)]
    table = [
        [
            [(each, state, reward, False) for state, reward in zip(*pair, strict=True)] + ends
            for pair in zip(following[number], rewards[number], strict=True)
        ]
        for number in range(states)
    ]
    return TabularEnv(table, np.eye(1, states)[0])

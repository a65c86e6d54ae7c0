"""Blackjack in the book's figures: the policy that sticks on 20 and 21, and episodes from a single state."""

from functools import cache
from typing import Any

import gymnasium as gym

from qtab import _core
from qtab.book.prediction_experiment import PredictionTask
from qtab.envs.native import table_env
from qtab.envs.tabular import TabularEnv
from qtab.planning.policy_values import policy_values

STATE = (13, 2, 1)
"""The state of Figure 5.3: a sum of 13 with a usable ace, and the dealer shows a two."""
_SHAPE = (32, 11, 2)


def sticks_on_20(observation: tuple[int, int, int]) -> int:
    """Returns the action of the book's policy: it sticks (0) on 20 and 21 and hits (1) otherwise."""
    return int(observation[0] < 20)


@cache
def blackjack() -> PredictionTask:
    """Returns the game by the book's rules with that policy."""
    env = gym.make("Blackjack-v1", sab=True)
    return PredictionTask(env, sticks_on_20, policy_values(env, sticks_on_20))


@cache
def single_state() -> PredictionTask:
    """Returns the game whose episodes begin in the state of Figure 5.3, as a table of its rules."""
    solver = _core.MdpSolver(table_env(gym.make("Blackjack-v1", sab=True).unwrapped))
    pairs, states = solver.transitions(), len(solver.rows)
    start = index_of(STATE)
    env = TabularEnv(
        [pairs[2 * state : 2 * state + 2] for state in range(states)],
        [float(state == start) for state in range(states)],
    )

    def policy(state: int) -> int:
        # Naturals, which have a sum of 21, come after the states that observations show.
        total = state // (_SHAPE[1] * _SHAPE[2])
        return int(total < 20 and state < _SHAPE[0] * _SHAPE[1] * _SHAPE[2])

    return PredictionTask(env, policy, policy_values(env, policy))


def index_of(observation: Any) -> int:
    """Returns the state of an observation in the table."""
    total, shown, ace = observation
    return int((total * _SHAPE[1] + shown) * _SHAPE[2] + ace)

"""``qtab.TabularEnv``: an environment from a table."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv
from gymnasium.envs.toy_text.utils import categorical_sample
from numpy.typing import ArrayLike

from qtab import _core
from qtab.envs.toy_text import ToyTextMixin

Outcome: TypeAlias = tuple[float, int, float, bool]
"""Probability, next state, reward, terminated."""
Outcomes: TypeAlias = Sequence[Outcome]
Table: TypeAlias = Mapping[int, Mapping[int, Outcomes]] | Sequence[Sequence[Outcomes]]
"""``P[state][action]`` lists the outcomes, as in Gymnasium's toy text."""


class TabularEnv(_core.Table, ToyTextMixin, gym.Env[Any, Any]):
    """A finite Markov decision process of one's own: states and actions numbered from 0, everything else in a table.

    It draws as Gymnasium's toy text does, one ``random()`` for each reset and each step, so that
    ``TabularEnv(env.P, env.initial_state_distrib)`` walks as a FrozenLake or CliffWalking ``env`` does. A subclass may
    add ``render``. There is no time limit; ``gymnasium.wrappers.TimeLimit`` adds one.

    Args:
        P: ``P[state][action]`` lists (probability, next state, reward, terminated), for every state the same actions.
        initial_state_distrib: (states,) the probability of each first state.

    Raises:
        TypeError: for what is no such table.
        ValueError: for a state or an action that is missing, probabilities that do not sum to 1 within 1e-9, a state
            outside the table, a reward that is not finite; it says where.
    """

    def __init__(self, P: Table, initial_state_distrib: ArrayLike) -> None:  # noqa: N803 - Gymnasium's name
        try:
            self.initial_state_distrib = np.array(initial_state_distrib, np.float64)
        except (TypeError, ValueError):
            raise TypeError(f"initial_state_distrib must hold numbers, got {initial_state_distrib!r}") from None
        if self.initial_state_distrib.ndim != 1:
            raise ValueError(f"initial_state_distrib must have one axis, got {self.initial_state_distrib.ndim}")
        checked = _core.Transitions(P, self.initial_state_distrib, exact=False)
        states, actions = checked.states, checked.actions
        # The lists are copies, so that this table changes only where it is changed itself.
        self.P: dict[int, dict[int, list[Outcome]]] = {
            state: {action: [_outcome(outcome) for outcome in P[state][action]] for action in range(actions)}
            for state in range(states)
        }
        self.observation_space = gym.spaces.Discrete(states)
        self.action_space = gym.spaces.Discrete(actions)

    def reset_in_python(self) -> tuple[int, dict[str, Any]]:
        """Draws by Gymnasium's own code what Rust does not stand for, such as a list of probabilities."""
        self.s = categorical_sample(self.initial_state_distrib, self.np_random)
        self.lastaction = None
        if self.render_mode == "human":
            self.render()
        return int(self.s), {"prob": 1}

    def step_in_python(self, action: Any) -> Any:
        """Steps through Gymnasium's own code what Rust does not stand for.

        Raises:
            AssertionError: for an action outside the space, as Gymnasium words it.
        """
        assert self.action_space.contains(action), f"{action!r} ({type(action)}) invalid"  # noqa: S101
        step: Any = FrozenLakeEnv.step  # it asks for no more than what is here
        return step(self, action)


def _outcome(outcome: Outcome) -> Outcome:
    probability, state, reward, terminated = outcome
    return float(probability), state, reward, terminated

"""``qtab.TabularEnv``: a finite Markov decision process given as a transition table."""

from collections.abc import Mapping, Sequence, Sized
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv
from gymnasium.envs.toy_text.utils import categorical_sample
from numpy.typing import ArrayLike

from qtab import _core
from qtab._utils.shown import counted, shown
from qtab.envs.toy_text import ToyTextMixin

Transition: TypeAlias = tuple[float, int, float, bool]
"""Probability, next state, reward, terminated."""
TransitionTable: TypeAlias = Mapping[int, Mapping[int, Sequence[Transition]]] | Sequence[Sequence[Sequence[Transition]]]
"""``P[state][action]`` lists the transitions, as in Gymnasium's toy text."""


class TabularEnv(_core.ToyText, ToyTextMixin, gym.Env[Any, Any]):
    """A finite Markov decision process given as a transition table, with states and actions numbered from 0.

    Each reset and each step draws one ``np_random.random()``, as in Gymnasium's toy text, so that
    ``TabularEnv(env.P, env.initial_state_distrib)`` visits the same states as a FrozenLake or CliffWalking ``env``. A
    subclass may define ``render``. There is no time limit; ``gymnasium.wrappers.TimeLimit`` adds one.

    Args:
        P: ``P[state][action]`` lists tuples (probability, next state, reward, terminated). Every state must have the
            same actions.
        initial_state_distrib: (states,) float: the probability that an episode starts in each state.

    Raises:
        TypeError: if ``P`` is not such a table, or ``initial_state_distrib`` does not hold numbers.
        ValueError: if a state or an action is missing, probabilities do not sum to 1 within 1e-9, a next state is not
            in the table, or a reward is not finite. The message names the place.
    """

    def __init__(self, P: TransitionTable, initial_state_distrib: ArrayLike) -> None:  # noqa: N803 - Gymnasium's name
        try:
            self.initial_state_distrib = np.array(initial_state_distrib, np.float64)
        except (TypeError, ValueError):
            raise TypeError(f"initial_state_distrib must hold numbers, got {shown(initial_state_distrib)}") from None
        if initial_state_distrib is None:
            raise TypeError("initial_state_distrib must hold numbers, got None")
        if self.initial_state_distrib.ndim != 1:
            raise ValueError(f"initial_state_distrib must have one axis, got {self.initial_state_distrib.ndim}")
        _check_not_empty(P)
        checked = _core.TransitionTable(P, self.initial_state_distrib)
        states, actions = checked.states, checked.actions
        # By the id of a list of transitions: the list, so that no other gets this id, and the copy that actions share.
        copies: dict[int, tuple[Sequence[Transition], list[Transition]]] = {}

        def copied(transitions: Sequence[Transition]) -> list[Transition]:
            if id(transitions) not in copies:
                copies[id(transitions)] = transitions, [_copy(transition) for transition in transitions]
            return copies[id(transitions)][1]

        # Copied, so that later changes to the argument do not change the environment.
        self.P: dict[int, dict[int, list[Transition]]] = {
            state: {action: copied(P[state][action]) for action in range(actions)} for state in range(states)
        }
        self.observation_space = gym.spaces.Discrete(states)
        self.action_space = gym.spaces.Discrete(actions)

    def __repr__(self) -> str:
        """Returns one line; Gymnasium would show an environment without an id by its address."""
        if self.spec is not None:
            return super().__repr__()
        states, actions = len(self.P), len(self.P[0])
        return f"<{type(self).__name__}: {counted(states, 'state')}, {counted(actions, 'action')}>"

    def _reset_in_python(self) -> tuple[int, dict[str, Any]]:
        """Resets in Gymnasium's code, for first-state distributions that Rust does not support, such as a list."""
        self.s = categorical_sample(self.initial_state_distrib, self.np_random)
        self.lastaction = None
        if self.render_mode == "human":
            self.render()
        return int(self.s), {"prob": 1}

    def _step_in_python(self, action: Any) -> Any:
        """Steps in Gymnasium's code, for tables that Rust does not support.

        Raises:
            AssertionError: for an action outside the space, with Gymnasium's message.
        """
        assert self.action_space.contains(action), f"{action!r} ({type(action)}) invalid"  # noqa: S101
        step: Any = FrozenLakeEnv.step  # it uses only attributes that this class has
        return step(self, action)


def _check_not_empty(P: TransitionTable) -> None:  # noqa: N803 - Gymnasium's name
    if isinstance(P, Sized) and len(P) == 0:
        raise ValueError("P must have at least 1 state, got none")
    try:
        first = P[0]
    except (LookupError, TypeError):  # refused when the table is read
        return
    if isinstance(first, Sized) and len(first) == 0:
        raise ValueError("P[0] must have at least 1 action, got none")


def _copy(transition: Transition) -> Transition:
    """Returns a transition with a float as its probability; a tuple that has one is not copied."""
    if type(transition) is tuple and type(transition[0]) is float:
        return transition
    probability, next_state, reward, terminated = transition
    return float(probability), next_state, reward, terminated

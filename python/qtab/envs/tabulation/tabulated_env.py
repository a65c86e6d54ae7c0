"""``qtab.TabulatedEnv``: the transition table of another environment."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab.envs.origin.description import EnvironmentDescription
from qtab.envs.tabular import TabularEnv, TransitionTable

MOST_NAMES = 1_000
"""The most states whose names a table keeps, since every run stores them."""


class TabulatedEnv(TabularEnv):
    """The transition table of another environment, as :func:`qtab.tabulate` makes it.

    The observation is the number of the state. ``train`` uses the masks with ``action_mask=True``. ``train`` and
    ``optimum`` end episodes after :attr:`max_episode_steps`; stepping in Python does not, as for every
    :class:`qtab.TabularEnv`.

    Args:
        P: The transitions; see :class:`qtab.TabularEnv`.
        initial_state_distrib: (states,) float: the probability that an episode starts in each state.
        state_names: A name for each state, which pictures and explanations show; () without names.
        action_names: A name for each action; () without names.
        masks: (states, actions) bool: the available actions; None if all are.
        max_episode_steps: The time limit of the other environment in steps; None without one.
    """

    states: tuple[Any, ...]
    """The states of the other environment, in the order of their numbers; numbers if its table was known."""
    observations: tuple[Any, ...]
    """The observations of these states in the other environment."""
    state_names: tuple[str, ...]
    """A name for each state; empty without names, or with more than 1,000 states."""
    action_names: tuple[str, ...]
    """A name for each action; empty without names."""
    masks: NDArray[np.bool_] | None
    """(states, actions): the available actions, in terminal states all; None if the other environment has no masks."""
    max_episode_steps: int | None
    """The time limit of the other environment in steps; None without one."""
    made_of: EnvironmentDescription | None
    """The other environment in detail; None if the table was not made by :func:`qtab.tabulate`."""

    def __init__(
        self,
        P: TransitionTable,  # noqa: N803 - Gymnasium's name
        initial_state_distrib: ArrayLike,
        *,
        state_names: Sequence[str] = (),
        action_names: Sequence[str] = (),
        masks: NDArray[np.bool_] | None = None,
        max_episode_steps: int | None = None,
    ) -> None:
        super().__init__(P, initial_state_distrib)
        # Not arguments, because runs store the arguments.
        self.states = self.observations = tuple(range(len(self.P)))
        self.state_names = tuple(state_names) if len(state_names) <= MOST_NAMES else ()
        self.action_names = tuple(action_names)
        self.masks = masks
        self.max_episode_steps = max_episode_steps
        self.made_of = None

    def action_mask(self, state: int) -> NDArray[np.int8]:
        """Returns the mask of a state, (actions,): 1 for each available action, and for all without masks.

        Args:
            state: The number of the state.
        """
        return np.ones(len(self.P[0]), np.int8) if self.masks is None else self.masks[state].astype(np.int8)

    def action_masks(self) -> NDArray[np.int8]:
        """Returns the mask of the current state, (actions,), as sb3-contrib asks for it."""
        return self.action_mask(int(self.s))

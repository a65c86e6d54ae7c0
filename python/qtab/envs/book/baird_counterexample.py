"""``qtab/BairdCounterexample-v0``: Baird's counterexample (Sutton & Barto, 2nd ed., section 11.2)."""

import numpy as np
from numpy.typing import NDArray

from qtab.envs.tabular import TabularEnv, Transition

DASHED, SOLID = range(2)
STATES = 7


class BairdCounterexampleEnv(TabularEnv):
    """Seven states, rewards of zero, and no end: off-policy TD with these features diverges.

    The dashed action (0) leads to one of the six upper states (0 to 5) with equal probability, the solid one (1) to the
    lower state (6). An episode starts in each state with equal probability. The book's behavior takes the solid action
    with probability 1/7, and its target policy takes it always.
    """

    def __init__(self) -> None:
        upper: list[Transition] = [(1.0 / (STATES - 1), state, 0.0, False) for state in range(STATES - 1)]
        lower: list[Transition] = [(1.0, STATES - 1, 0.0, False)]
        super().__init__([[upper, lower] for _ in range(STATES)], np.full(STATES, 1.0 / STATES))

    @property
    def features(self) -> NDArray[np.float64]:
        """(7, 8): the book's feature vectors, with the values 2 w_s + w_8 in the upper states and w_7 + 2 w_8 below."""
        features = 2.0 * np.eye(STATES, STATES + 1)
        features[:, -1] = 1.0
        features[-1, -2:] = 1.0, 2.0
        return features

    @property
    def behavior(self) -> NDArray[np.float64]:
        """(7, 2): the probabilities of the actions in the book's behavior. All states are equally likely under it."""
        return np.tile([1.0 - 1.0 / STATES, 1.0 / STATES], (STATES, 1))

    @property
    def target(self) -> NDArray[np.float64]:
        """(7, 2): the probabilities of the actions in the target policy."""
        return np.tile([0.0, 1.0], (STATES, 1))

"""``qtab/BoyanChain-v0``: the chain on which J. Boyan compared LSTD with TD (Machine Learning 49, 2002)."""

import numpy as np
from numpy.typing import NDArray

from qtab.envs.tabular import TabularEnv, Transition

STATES = 13
SPACING = 4
"""The number of states between those in which a single feature is active."""


class BoyanChainEnv(TabularEnv):
    """Thirteen states in a row, numbered down from 12 to 0; the value of state s is -2 s, without a discount.

    The only action leads from state s to s - 1 or s - 2 with equal probability and a reward of -3, from state 1 to 0
    with a reward of -2, and from state 0 to the end with a reward of 0. An episode starts in state 12.
    """

    def __init__(self) -> None:
        rows: list[list[Transition]] = [[(1.0, 0, 0.0, True)], [(1.0, 0, -2.0, False)]]
        rows += [[(0.5, state - 1, -3.0, False), (0.5, state - 2, -3.0, False)] for state in range(2, STATES)]
        super().__init__([[row] for row in rows], np.eye(STATES)[-1])

    @property
    def features(self) -> NDArray[np.float64]:
        """(13, 4): x(s) is a unit vector in the states 12, 8, 4 and 0, and interpolated linearly between them.

        The weights -24, -16, -8 and 0 give the exact values.
        """
        peaks = np.arange(STATES - 1, -1, -SPACING)
        distance = np.abs(np.arange(STATES)[:, None] - peaks) / SPACING
        features: NDArray[np.float64] = np.maximum(0.0, 1.0 - distance)
        return features

"""The words that a config's choices take."""

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

Algorithm: TypeAlias = Literal[
    "q_learning",
    "sarsa",
    "expected_sarsa",
    "double_q_learning",
    "n_step_sarsa",
    "sarsa_lambda",
    "true_online_sarsa_lambda",
    "watkins_q_lambda",
    "dyna_q",
    "dyna_q_plus",
]
LearningRateSchedule: TypeAlias = Literal["constant", "linear", "exponential", "visits"]
Exploration: TypeAlias = Literal["epsilon_greedy", "softmax"]
EpsilonSchedule: TypeAlias = Literal["constant", "linear", "exponential"]
Ties: TypeAlias = Literal["first", "random"]
Traces: TypeAlias = Literal["accumulating", "replacing", "clearing"]
Discretizer: TypeAlias = Literal["round", "bins", "edges", "tiles", "identity"]
TerminalUpdate: TypeAlias = Literal["target", "assign"]
OnTruncation: TypeAlias = Literal["bootstrap", "terminate"]
BitGenerator: TypeAlias = Literal["PCG64", "MT19937"]
Backend: TypeAlias = Literal["auto", "rust", "gymnasium"]
Actions: TypeAlias = int | tuple[float | tuple[float, ...], ...]
InitialQ: TypeAlias = float | tuple[float, float] | NDArray[np.float64]

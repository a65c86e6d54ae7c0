"""What the extension module is handed: a run's description, every default resolved and every value checked."""

from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray


class Model(TypedDict):
    """An environment that Rust knows."""

    model: str
    parameters: dict[str, float]


class PythonEnvironment(TypedDict):
    """An environment that is stepped in Python."""

    env: Any
    seed: int
    first_action: int


class Plan(TypedDict):
    """Everything else."""

    low: list[float]
    high: list[float]
    single: bool
    scale: list[float]
    actions: int
    max_episode_steps: int | None
    seed: list[int]
    bit_generator: str
    initial_q: NDArray[np.float64] | tuple[float, float]
    learning_rate: float
    discount: float
    epsilon: float
    min_epsilon: float
    episodes: int
    terminal_update: str
    record: int


class Results(TypedDict):
    """Where many runs leave their results: a row for each."""

    returns: NDArray[np.float64]
    lengths: NDArray[np.int64]
    terminated: NDArray[np.bool_]
    tables: NDArray[np.float64]
    finished: NDArray[np.bool_]


def seed_words(seed: int) -> list[int]:
    """Returns a non-negative integer as 32-bit words, least significant first; zero is one word."""
    count = max(1, (seed.bit_length() + 31) // 32)
    return [(seed >> (32 * index)) & 0xFFFF_FFFF for index in range(count)]

"""What the extension module is handed: a run's description, every default resolved and every value checked."""

from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from qtab._core import Classic, Transitions
    from qtab.config import Config


class Control(TypedDict):
    """An environment of classic control that Rust knows, and the actions of a continuous one."""

    constants: "Classic"
    forces: list[float]


class PythonEnvironment(TypedDict):
    """An environment that is stepped in Python."""

    env: Any
    seed: int
    first_action: int
    choices: list[NDArray[np.floating]]


class Process(TypedDict):
    """A table that Rust steps by."""

    table: "Transitions"
    fickle: float | None


class Rules(TypedDict):
    """Those of blackjack."""

    natural: bool
    sab: bool


class Bias(TypedDict):
    """The example of maximisation bias."""

    actions: int
    mean: float
    deviation: float


class Rounding(TypedDict):
    """The article's grid."""

    scale: list[float]


class Tiles(TypedDict):
    """Tile coding."""

    low: list[float]
    high: list[float]
    tiles: list[int]
    tilings: int
    hashed_rows: int | None


class Cells(TypedDict):
    """Whole numbers, each combination a row."""

    first: list[int]
    counts: list[int]
    scalar: bool


class Bins(TypedDict):
    """Between edges."""

    edges: list[list[float]]


Features: TypeAlias = Rounding | Tiles | Cells | Bins


class Course(TypedDict):
    """A rate from episode to episode."""

    schedule: str
    value: float
    least: float
    decay: float
    warm_up: int


class EpsilonGreedy(TypedDict):
    """A way of choosing actions."""

    epsilon: Course
    ties: str


class Softmax(TypedDict):
    """Another."""

    temperature: float


class Algorithm(TypedDict):
    """A learner, with its own options; the others are None."""

    name: str
    trace_decay: float | None
    traces: str | None
    trace_cutoff: float | None
    n_steps: int | None
    planning_steps: int | None
    time_weight: float | None


class Plan(TypedDict):
    """Everything else."""

    low: list[float]
    high: list[float]
    single: bool
    features: Features
    actions: int
    max_episode_steps: int | None
    seed: list[int]
    bit_generator: str
    initial_q: NDArray[np.float64] | tuple[float, float] | float
    learning_rate: Course
    discount: float
    policy: EpsilonGreedy | Softmax
    episodes: int
    terminal_update: str
    on_truncation: str
    algorithm: Algorithm
    record: int


class Results(TypedDict):
    """Where many runs leave their results: a row for each."""

    returns: NDArray[np.float64]
    lengths: NDArray[np.int64]
    terminated: NDArray[np.bool_]
    tables: NDArray[np.float64]
    finished: NDArray[np.bool_]


Solved: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]
"""Of a table: values, values of the actions, the policy."""
Changes: TypeAlias = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]
"""From how many steps left on, in which state, which action is best."""


def seed_words(seed: int) -> list[int]:
    """Returns a non-negative integer as 32-bit words, least significant first; zero is one word."""
    count = max(1, (seed.bit_length() + 31) // 32)
    return [(seed >> (32 * index)) & 0xFFFF_FFFF for index in range(count)]


def learning_rate(config: "Config") -> Course:
    """Returns the course of a resolved config's learning rate."""
    return {
        "schedule": config.learning_rate_schedule,
        "value": config.learning_rate,
        "least": config.min_learning_rate or 0.0,
        "decay": config.learning_rate_decay or 0.0,
        "warm_up": config.learning_rate_warm_up or 0,
    }


def policy(config: "Config") -> EpsilonGreedy | Softmax:
    """Returns how a resolved config chooses actions."""
    if config.temperature is not None:
        return {"temperature": config.temperature}
    assert config.epsilon is not None  # noqa: S101 - resolved
    assert config.epsilon_schedule is not None  # noqa: S101
    assert config.ties is not None  # noqa: S101
    course: Course = {
        "schedule": config.epsilon_schedule,
        "value": config.epsilon,
        "least": config.min_epsilon or 0.0,
        "decay": config.epsilon_decay or 0.0,
        "warm_up": config.epsilon_warm_up or 0,
    }
    return {"epsilon": course, "ties": config.ties}


def algorithm(config: "Config") -> Algorithm:
    """Returns a resolved config's learner."""
    return {
        "name": config.algorithm,
        "trace_decay": config.trace_decay,
        "traces": config.traces,
        "trace_cutoff": config.trace_cutoff,
        "n_steps": config.n_steps,
        "planning_steps": config.planning_steps,
        "time_weight": config.time_weight,
    }

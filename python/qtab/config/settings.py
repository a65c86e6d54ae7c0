"""The types of the arguments for settings, for ``**settings: Unpack[Settings]``.

They are wider than the types that :class:`qtab.Config` stores: ``tiles=8`` works as well as ``tiles=(8, 8)``, and
NumPy's scalars and arrays work as well as Python's numbers and tuples. A test compares the names with the config's.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from typing_extensions import TypedDict  # a package that Gymnasium requires

from qtab.config.choices import (
    Algorithm,
    Backend,
    BitGenerator,
    DiscretizerName,
    EpsilonSchedule,
    Exploration,
    LearningRateSchedule,
    ModelKind,
    OnTruncation,
    TargetPolicy,
    TerminalUpdate,
    Ties,
    Traces,
)

if TYPE_CHECKING:
    Integer: TypeAlias = int | np.integer
    Real: TypeAlias = float | np.floating | np.integer
    Array: TypeAlias = NDArray[np.floating | np.integer]
    Integers: TypeAlias = Sequence[Integer] | NDArray[np.integer]
    Reals: TypeAlias = Sequence[Real] | Array
else:
    # The types that help() shows: shorter, and without NumPy's types beside every number.
    Integer, Real, Array, Integers, Reals = int, float, np.ndarray, Sequence[int], Sequence[float]


class EnvironmentSettings(TypedDict, total=False):
    """The settings of the environment."""

    env_kwargs: Mapping[str, Any]
    max_episode_steps: Integer | None
    time_aware: bool
    backend: Backend


class SharedSettings(EnvironmentSettings, total=False):
    """The settings that runs with different seeds can share."""

    episodes: Integer
    bit_generator: BitGenerator
    preset: str | None
    algorithm: Algorithm
    learning_rate: Real
    discount: Real
    learning_rate_schedule: LearningRateSchedule
    min_learning_rate: Real | None
    learning_rate_decay: Real | None
    learning_rate_warm_up: Integer | None
    trace_decay: Real | None
    traces: Traces | None
    trace_cutoff: Real | None
    n_steps: Integer | None
    sigma: Real | None
    target_policy: TargetPolicy | None
    planning_steps: Integer | None
    time_weight: Real | None
    model: ModelKind | None
    priority_threshold: Real | None
    reward_learning_rate: Real | None
    baseline: bool | None
    value_learning_rate: Real | None
    initial_q: Real | tuple[Real, Real] | list[Any] | Array
    terminal_update: TerminalUpdate
    on_truncation: OnTruncation
    exploration: Exploration
    epsilon: Real | None
    epsilon_schedule: EpsilonSchedule | None
    min_epsilon: Real | None
    epsilon_decay: Real | None
    epsilon_warm_up: Integer | None
    ties: Ties | None
    temperature: Real | None
    count_bonus: Real
    confidence: Real | None
    action_mask: bool | Callable[[Any], Any]
    discretizer: DiscretizerName | Callable[[Any], Any] | Mapping[str, Any]
    shape: Integer | Integers | None
    max_rows: Integer | None
    scale: Reals
    tilings: Integer | None
    tiles: Integer | Integers | None
    hashed_rows: Integer | None
    bins: Integer | Integers | None
    edges: Sequence[Reals] | None
    order: Integer | None
    coupled: bool | None
    scale_step_sizes: bool | None
    centers: Integer | Integers | None
    width: Real | Reals | None
    normalized: bool | None
    radius: Real | Reals | None
    low: Reals | None
    high: Reals | None
    actions: Integer | Sequence[Real | Reals] | Array | None


class Settings(SharedSettings, total=False):
    """The settings of a run in a given environment."""

    seed: Integer | None


class ConfigSettings(Settings, total=False):
    """All settings: the fields of :class:`qtab.Config`."""

    env: str

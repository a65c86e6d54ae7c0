"""The one place of every default: what a run is made from."""

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from qtab import checks

BitGenerator: TypeAlias = Literal["PCG64", "MT19937"]
Backend: TypeAlias = Literal["auto", "rust", "gymnasium"]
TerminalUpdate: TypeAlias = Literal["target", "assign"]
InitialQ: TypeAlias = tuple[float, float] | NDArray[np.float64]

LARGEST_MT19937_SEED = 2**32 - 1


@dataclass(frozen=True, eq=False)
class Config:
    """All that it takes to repeat a run.

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for a value that is out of range.
    """

    env: str = "MountainCar-v0"
    """Gymnasium's id of the environment."""
    env_kwargs: Mapping[str, Any] = field(default_factory=dict)
    """Keyword arguments of the environment's constructor."""
    episodes: int = 5000
    """How many episodes to train."""
    learning_rate: float = 0.2
    """α: the share of each error that an update corrects, in [0, 1]."""
    discount: float = 0.9
    """γ: what a reward is worth one step later, in [0, 1]."""
    epsilon: float = 0.8
    """ε: the exploration rate of the first episode, in [0, 1]."""
    min_epsilon: float = 0.0
    """The exploration rate after the last episode, in [0, epsilon]; in between it falls linearly."""
    scale: tuple[float, ...] = ()
    """Cells per unit of each component of the observation: (10, 100) rounds to 0.1 and 0.01."""
    initial_q: InitialQ = (-1.0, 1.0)
    """The first Q table: drawn uniformly from a range (low, high), or an array to go on from."""
    terminal_update: TerminalUpdate = "target"
    """At a terminal state: move towards the reward (the book's rule), or assign it (the article's)."""
    max_episode_steps: int | None = None
    """The time limit; None means the environment's own, and 10,000 where it has none."""
    seed: int | None = None
    """Seeds the environment and the agent; None draws one and records it."""
    bit_generator: BitGenerator = "PCG64"
    """The agent's stream: NumPy's default_rng, or what np.random.seed sets."""
    backend: Backend = "auto"
    """Where the environment steps: in Rust, in Gymnasium, or in Rust where it can."""
    preset: str | None = None
    """A named set of values to start from; None means the environment's own."""

    def __post_init__(self) -> None:
        """Refuses bad values and turns NumPy's numbers into Python's."""
        if not isinstance(self.env, str):
            raise TypeError(f"env must be an environment id, got {self.env!r}")
        checked = {
            "env_kwargs": _keywords(self.env_kwargs),
            "episodes": checks.count("episodes", self.episodes, least=1),
            "learning_rate": checks.real("learning_rate", self.learning_rate, 0, 1),
            "discount": checks.real("discount", self.discount, 0, 1),
            "epsilon": checks.real("epsilon", self.epsilon, 0, 1),
            "min_epsilon": checks.real("min_epsilon", self.min_epsilon, 0, 1),
            "scale": _scale(self.scale),
            "initial_q": _initial_q(self.initial_q),
            "terminal_update": checks.choice("terminal_update", self.terminal_update, get_args(TerminalUpdate)),
            "bit_generator": checks.choice("bit_generator", self.bit_generator, get_args(BitGenerator)),
            "backend": checks.choice("backend", self.backend, get_args(Backend)),
        }
        if self.max_episode_steps is not None:
            checked["max_episode_steps"] = checks.count("max_episode_steps", self.max_episode_steps, least=1)
        if self.seed is not None:
            most = LARGEST_MT19937_SEED if self.bit_generator == "MT19937" else None
            checked["seed"] = checks.integer("seed", self.seed, least=0, most=most)
        if self.preset is not None and not isinstance(self.preset, str):
            raise TypeError(f"preset must be a name, got {self.preset!r}")
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        if self.min_epsilon > self.epsilon:
            raise ValueError(f"min_epsilon must lie in [0, epsilon = {self.epsilon:g}], got {self.min_epsilon!r}")

    def replace(self, **changes: Any) -> "Config":
        """Returns a copy with some fields changed.

        Raises:
            TypeError: for an unknown field.
        """
        known_fields(changes)
        return dataclasses.replace(self, **changes)


def known_fields(names: Mapping[str, Any]) -> None:
    """Refuses what is no field of the config.

    Raises:
        TypeError: names the first unknown field, and the ones there are.
    """
    fields = [field.name for field in dataclasses.fields(Config)]
    for name in names:
        if name not in fields:
            raise TypeError(f"{name!r} is no setting of a run; there are {', '.join(fields)}")


def _keywords(value: Any) -> dict[str, Any]:
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise TypeError(f"env_kwargs must map names to values, got {value!r}")
    return dict(value)


def _scale(value: Any) -> tuple[float, ...]:
    if isinstance(value, (str, bytes)) or not hasattr(value, "__iter__"):
        raise TypeError(f"scale must hold a number for each component of the observation, got {value!r}")
    scale = tuple(checks.finite("scale", number) for number in value)
    if any(number <= 0 for number in scale):
        raise ValueError(f"scale must hold positive numbers, got {value!r}")
    return scale


def _initial_q(value: Any) -> InitialQ:
    if isinstance(value, tuple | list) and len(value) == 2 and not any(hasattr(part, "__len__") for part in value):
        low, high = (checks.finite("initial_q", bound) for bound in value)
        if low > high:
            raise ValueError(f"initial_q must be a range (low, high) with low <= high, got {value!r}")
        if not math.isfinite(high - low):
            raise ValueError(f"initial_q must be a range (low, high) with a finite width, got {value!r}")
        return low, high
    if not isinstance(value, np.ndarray | list):
        raise TypeError(f"initial_q must be a range (low, high) or a table, got {value!r}")
    try:
        table = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"initial_q must be a range (low, high) or a table of numbers, got {value!r}") from None
    if not np.isfinite(table).all():
        raise ValueError("initial_q must hold finite numbers, got a table with nan or infinity")
    table.flags.writeable = False
    return table

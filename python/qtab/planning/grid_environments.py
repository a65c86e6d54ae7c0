"""The environments of classic control whose best known policies are found on a grid over their states."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from gymnasium.envs.classic_control import AcrobotEnv, CartPoleEnv, MountainCarEnv, PendulumEnv
from numpy.typing import ArrayLike, NDArray

from qtab.envs import classic_control as rust


@dataclass(frozen=True, eq=False)
class GridEnvironment:
    """An environment whose best known policy is found on a grid over its states."""

    name: str
    """Its name in Rust."""
    classes: tuple[type, ...]
    """The classes of Gymnasium and of qtab."""
    starts: NDArray[np.float64]
    """(starts, components): states that cover Gymnasium's range of start states evenly."""
    state_of: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    """Maps the components of an observation to those of the state."""
    observations_of: Callable[[NDArray[np.float64]], NDArray[np.float32]]
    """Maps (n, components) states to (n, components) observations."""
    observation: str
    """The description of an observation, for messages."""
    observation_length: int
    """The number of components of an observation."""
    beam: int = 0
    """The number of states that the search for a route keeps after each step; 0 if there is no goal."""
    starts_at_rest: bool = False
    """Whether only the first component of each start is given."""
    flags: Mapping[str, Any] = field(default_factory=dict)
    """The value that means true in Rust, for each attribute with two possible values."""
    fixed: Mapping[str, Any] = field(default_factory=dict)
    """Constants whose values the search assumes."""


def even_points(low: ArrayLike, high: ArrayLike, count: int) -> NDArray[np.float64]:
    """Returns (count, components) points that cover a box evenly, by an additive recurrence.

    M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
    """
    lower, upper = np.array(low), np.array(high)
    root = 2.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (len(lower) + 1))
    steps = root ** -np.arange(1.0, len(lower) + 1)
    return np.asarray(lower + (upper - lower) * ((0.5 + np.arange(1, count + 1)[:, None] * steps) % 1.0))


def _midpoints(low: float, high: float, count: int) -> NDArray[np.float64]:
    """Returns (count, 2) states at rest: the midpoints of equal parts of a range of positions."""
    positions = low + (high - low) * ((np.arange(count) + 0.5) / count)
    return np.stack((positions, np.zeros(count)), axis=1)


def _of_pendulum(observation: NDArray[np.float64]) -> NDArray[np.float64]:
    cosine, sine, speed = observation
    return np.array([np.arctan2(sine, cosine), speed])


def _of_acrobot(observation: NDArray[np.float64]) -> NDArray[np.float64]:
    cosine1, sine1, cosine2, sine2, *speeds = observation
    return np.array([np.arctan2(sine1, cosine1), np.arctan2(sine2, cosine2), *speeds])


def _acrobots(states: NDArray[np.float64]) -> NDArray[np.float32]:
    first, second, *speeds = states.T
    parts = (np.cos(first), np.sin(first), np.cos(second), np.sin(second), *speeds)
    return np.stack(parts, axis=1).astype(np.float32)


def _pendulums(states: NDArray[np.float64]) -> NDArray[np.float32]:
    angle, speed = states.T
    return np.stack((np.cos(angle), np.sin(angle), speed), axis=1).astype(np.float32)


def _itself(observation: NDArray[np.float64]) -> NDArray[np.float64]:
    return observation


def _as_float32(states: NDArray[np.float64]) -> NDArray[np.float32]:
    return states.astype(np.float32)


# A beam of 1,024 shortens MountainCar's routes by a hundredth of a step and takes a hundred times as long; one of 256
# shortens Acrobot's by one step.
ENVIRONMENTS = (
    GridEnvironment(
        "MountainCar",
        (MountainCarEnv, rust.MountainCarEnv),
        _midpoints(-0.6, -0.4, 1000),
        _itself,
        _as_float32,
        "a position and a velocity",
        2,
        beam=16,
        starts_at_rest=True,
    ),
    GridEnvironment(
        "CartPole",
        (CartPoleEnv, rust.CartPoleEnv),
        even_points([-0.05] * 4, [0.05] * 4, 1000),
        _itself,
        _as_float32,
        "position, velocity, angle and angular velocity",
        4,
        flags={"kinematics_integrator": "euler", "_sutton_barto_reward": True},
    ),
    GridEnvironment(
        "Acrobot",
        (AcrobotEnv, rust.AcrobotEnv),
        even_points([-0.1] * 4, [0.1] * 4, 100).astype(np.float32).astype(np.float64),
        _of_acrobot,
        _acrobots,
        "cosine and sine of both angles and both angular velocities",
        6,
        beam=32,
        flags={"book_or_nips": "nips"},
        fixed={"torque_noise_max": 0.0, "AVAIL_TORQUE": [-1.0, 0.0, 1.0]},
    ),
    GridEnvironment(
        "Pendulum",
        (PendulumEnv, rust.PendulumEnv),
        even_points([-np.pi, -1.0], [np.pi, 1.0], 1000),
        _of_pendulum,
        _pendulums,
        "cosine and sine of the angle and the angular velocity",
        3,
    ),
)


def grid_environment(env: Any) -> GridEnvironment | None:
    """Returns the parameters of the search for the best policy; None for an environment of any other class."""
    return next((known for known in ENVIRONMENTS if type(env) in known.classes), None)

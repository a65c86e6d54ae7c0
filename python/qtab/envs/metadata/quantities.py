"""Names and units of the observations and actions of Gymnasium's environments and of this package's.

They come from Gymnasium's documentation, which names the components of observations and the actions in tables. Axes of
pictures, ``run.axes`` and ``run.action_names`` show them. An environment that is not listed has neutral names.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.envs.registry import entry_for_id, gymnasium_id


@dataclass(frozen=True)
class Quantity:
    """A component of an observation, or of a continuous action."""

    name: str
    """Its name, in lower case."""
    unit: str = ""
    """Its unit; empty if it has none."""
    values: tuple[str, ...] = ()
    """The names of its values in order, if it is discrete and they have names."""

    @property
    def label(self) -> str:
        """The name and the unit, as axes show them."""
        return f"{self.name} ({self.unit})" if self.unit else self.name


@dataclass(frozen=True)
class Angle:
    """An angle that an observation gives by its cosine and its sine."""

    quantity: Quantity
    cosine: int
    """The component that is the cosine."""
    sine: int
    """The component that is the sine."""


@dataclass(frozen=True)
class Mark:
    """A value of a component to mark in pictures, such as a goal."""

    name: str
    """The name of the component."""
    value: float
    text: str


@dataclass(frozen=True)
class Quantities:
    """The names and units of an environment's numbers, and their place in pictures."""

    observation: tuple[Quantity, ...] = ()
    """The components of an observation."""
    actions: tuple[str, ...] = ()
    """The names of the actions of a Discrete space."""
    continuous_actions: tuple[Quantity, ...] = ()
    """The components of an action of a Box."""
    angles: tuple[Angle, ...] = ()
    """The angles that pictures show instead of their cosines and sines."""
    plane: tuple[str, ...] = ()
    """The two quantities along the axes of a picture by default, if there are more than two."""
    marks: tuple[Mark, ...] = ()
    """The marks along the axes of pictures."""
    layout: Literal["", "map", "taxi", "blackjack"] = ""
    """The arrangement of states in pictures; empty for the axes of the observation."""
    bounds: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    """The lower and the upper bounds of the observations, if they are a Box."""


_POSITION, _VELOCITY = Quantity("position", "m"), Quantity("velocity", "m/step")
_STATE = (Quantity("state"),)
_CAR = ((-1.2, -0.07), (0.6, 0.07))
_TILT = 24 * 2 * math.pi / 360
"""The largest angle of CartPole's pole."""

_CART_POLE = Quantities(
    (
        Quantity("cart position", "m"),
        Quantity("cart velocity", "m/s"),
        Quantity("pole angle", "rad"),
        Quantity("pole angular velocity", "rad/s"),
    ),
    ("push left", "push right"),
    plane=("pole angle", "pole angular velocity"),
    bounds=((-4.8, -math.inf, -_TILT, -math.inf), (4.8, math.inf, _TILT, math.inf)),
)

QUANTITIES: Mapping[str, Quantities] = {
    "MountainCar-v0": Quantities(
        (_POSITION, _VELOCITY),
        ("push left", "no push", "push right"),
        marks=(Mark("position", 0.5, "flag"),),
        bounds=_CAR,
    ),
    "MountainCarContinuous-v0": Quantities(
        (_POSITION, _VELOCITY),
        continuous_actions=(Quantity("force"),),
        marks=(Mark("position", 0.45, "flag"),),
        bounds=_CAR,
    ),
    "CartPole-v0": _CART_POLE,
    "CartPole-v1": _CART_POLE,
    "Acrobot-v1": Quantities(
        (
            Quantity("cos θ1"),
            Quantity("sin θ1"),
            Quantity("cos θ2"),
            Quantity("sin θ2"),
            Quantity("angular velocity of θ1", "rad/s"),
            Quantity("angular velocity of θ2", "rad/s"),
        ),
        ("torque -1", "torque 0", "torque +1"),
        angles=(Angle(Quantity("θ1", "rad"), 0, 1), Angle(Quantity("θ2", "rad"), 2, 3)),
        plane=("θ1", "θ2"),
        bounds=((-1, -1, -1, -1, -4 * math.pi, -9 * math.pi), (1, 1, 1, 1, 4 * math.pi, 9 * math.pi)),
    ),
    "Pendulum-v1": Quantities(
        (Quantity("cos θ"), Quantity("sin θ"), Quantity("angular velocity", "rad/s")),
        continuous_actions=(Quantity("torque", "N m"),),
        angles=(Angle(Quantity("θ", "rad"), 0, 1),),
        plane=("θ", "angular velocity"),
        bounds=((-1, -1, -8), (1, 1, 8)),
    ),
    "FrozenLake-v1": Quantities(_STATE, ("left", "down", "right", "up"), layout="map"),
    "FrozenLake8x8-v1": Quantities(_STATE, ("left", "down", "right", "up"), layout="map"),
    "CliffWalking-v1": Quantities(_STATE, ("up", "right", "down", "left"), layout="map"),
    "CliffWalkingSlippery-v1": Quantities(_STATE, ("up", "right", "down", "left"), layout="map"),
    "Taxi-v4": Quantities(_STATE, ("south", "north", "east", "west", "pick up", "drop off"), layout="taxi"),
    "Blackjack-v1": Quantities(
        (Quantity("player's sum"), Quantity("dealer's card"), Quantity("usable ace", values=("no", "yes"))),
        ("stick", "hit"),
        layout="blackjack",
    ),
    "qtab/AccessControlQueue-v0": Quantities(_STATE, ("reject", "accept")),
    "qtab/BairdCounterexample-v0": Quantities(_STATE, ("dashed", "solid")),
    "qtab/BoyanChain-v0": Quantities(_STATE, ("step",)),
    "qtab/BlockingMaze-v0": Quantities(_STATE, ("up", "right", "down", "left")),
    "qtab/DynaMaze-v0": Quantities(_STATE, ("up", "right", "down", "left")),
    "qtab/Racetrack-v0": Quantities(
        _STATE, tuple(f"{up:+} up, {right:+} right" for up in (-1, 0, 1) for right in (-1, 0, 1))
    ),
    "qtab/ShortcutMaze-v0": Quantities(_STATE, ("up", "right", "down", "left")),
    "qtab/GamblersProblem-v0": Quantities(
        (Quantity("capital", "$"),), tuple(f"stake {stake}" for stake in range(1, 51))
    ),
    "qtab/GridWorld4x4-v0": Quantities(_STATE, ("up", "right", "down", "left")),
    "qtab/GridWorld5x5-v0": Quantities(_STATE, ("up", "right", "down", "left")),
    "qtab/JacksCarRental-v0": Quantities(_STATE, tuple(f"move {moved}" for moved in range(-5, 6))),
    "qtab/RandomMdp-v0": Quantities(_STATE, ("first", "second")),
    "qtab/RandomWalk-v0": Quantities(_STATE, ("left", "right")),
    "qtab/KArmedBandit-v0": Quantities(
        (Quantity("state", values=("bandit",)),), tuple(f"arm {number}" for number in range(1, 11))
    ),
    "qtab/ShortCorridor-v0": Quantities((Quantity("state", values=("corridor",)),), ("left", "right")),
    "qtab/MaximizationBias-v0": Quantities((Quantity("state", values=("A", "B", "end")),), ("right", "left")),
}
"""The environments by their id."""

_WRAPPERS = {
    f"gymnasium.wrappers.{how}_{kind}": kind
    for how in ("transform", "stateful")
    for kind in ("observation", "action", "reward")
}
"""The part of an environment that the wrappers in each module of Gymnasium change."""

UNKNOWN = Quantities()
"""Those of an environment that is not listed: nothing is known."""


def quantities_of(env: str) -> Quantities:
    """Returns the quantities of an id, of Gymnasium's or of this package's; ``UNKNOWN`` for any other.

    It is also ``UNKNOWN`` if another class, or wrappers, are registered under the id.
    """
    bare = env.rpartition(":")[2]
    entry, spec = entry_for_id(bare), gym.registry.get(bare)
    if entry is None or spec is None or spec.additional_wrappers:
        return UNKNOWN
    if spec.entry_point not in (entry.gymnasium_entry_point, entry.entry_point):
        return UNKNOWN
    return QUANTITIES.get(bare) or QUANTITIES[gymnasium_id(bare)]


def observed_quantities(env: str, low: NDArray[Any], high: NDArray[Any]) -> Quantities:
    """Returns the quantities of an environment whose observations have these bounds, (d,) or ().

    If the bounds are not the environment's, a wrapper changes its observations, which are then unknown.
    """
    known = quantities_of(env)
    if known.bounds is None:
        return known
    own = np.array(known.bounds)
    if low.shape == own[0].shape and np.allclose([low, high], own, rtol=1e-6):
        return known
    return _actions_of(known)


def tabulated_quantities(attributes: Mapping[str, Any]) -> Quantities:
    """Returns the names of the states and actions of a ``TabulatedEnv`` from the description of its attributes."""
    states, actions = (
        tuple(map(str, stored.get("items", ()))) if isinstance(stored, Mapping) else ()
        for stored in (attributes.get("state_names"), attributes.get("action_names"))
    )
    return Quantities((Quantity("state", values=states),), actions)


def behind(known: Quantities, wrappers: Iterable[str]) -> Quantities:
    """Returns the quantities that are still known behind wrappers, which are given as ``"module:Class"``.

    Gymnasium's wrappers of rewards keep all of it, those of observations keep the actions, and those of actions keep
    the observations. Any other wrapper may change everything.
    """
    for wrapper in wrappers:
        kind = _WRAPPERS.get(wrapper.partition(":")[0])
        if kind in (None, "observation"):
            known = _actions_of(known)
        if kind in (None, "action"):
            known = replace(known, actions=(), continuous_actions=())
    return known


def _actions_of(known: Quantities) -> Quantities:
    return Quantities(actions=known.actions, continuous_actions=known.continuous_actions)


def observation_quantities(known: Quantities, count: int) -> tuple[Quantity, ...]:
    """Returns the ``count`` components of an environment's observations; neutral names if they do not fit."""
    if len(known.observation) == count:
        return known.observation
    return _STATE if count == 1 else tuple(Quantity(f"observation[{index}]") for index in range(count))

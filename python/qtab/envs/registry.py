"""Which of Gymnasium's environments Rust knows: one line each."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec, find_highest_version, get_env_id, parse_env_id

PACKAGE = "qtab"
PREFIX = "qtab/"


@dataclass(frozen=True)
class EnvEntry:
    """An environment in Rust, and where it stands in Gymnasium."""

    name: str
    """The model's name in Rust."""
    gymnasium: str
    """Gymnasium's entry point."""
    qtab: str
    """This package's entry point."""
    arguments: frozenset[str] = field(default_factory=frozenset)
    """The constructor's keyword arguments that make constants of the model, and nothing else."""
    has_table: bool = False
    """Whether Rust takes its table, or its rules, from Gymnasium's environment, whatever its arguments were."""


_CLASSIC = "gymnasium.envs.classic_control"
_TOYS = "gymnasium.envs.toy_text"
TABULAR = EnvEntry("Table", "", "qtab.envs.tabular:TabularEnv", has_table=True)
"""A table of one's own, which has no id."""
_FROZEN_LAKE = EnvEntry(
    "FrozenLake", f"{_TOYS}.frozen_lake:FrozenLakeEnv", "qtab.envs.toy_text:FrozenLakeEnv", has_table=True
)
_CLIFF = EnvEntry(
    "CliffWalking", f"{_TOYS}.cliffwalking:CliffWalkingEnv", "qtab.envs.toy_text:CliffWalkingEnv", has_table=True
)
_CART_POLE = EnvEntry(
    name="CartPole",
    gymnasium=f"{_CLASSIC}.cartpole:CartPoleEnv",
    qtab="qtab.envs.classic_control:CartPoleEnv",
    arguments=frozenset({"sutton_barto_reward"}),
)

ENTRIES: Mapping[str, EnvEntry] = {
    "MountainCar-v0": EnvEntry(
        name="MountainCar",
        gymnasium=f"{_CLASSIC}.mountain_car:MountainCarEnv",
        qtab="qtab.envs.classic_control:MountainCarEnv",
        arguments=frozenset({"goal_velocity"}),
    ),
    "MountainCarContinuous-v0": EnvEntry(
        name="ContinuousMountainCar",
        gymnasium=f"{_CLASSIC}.continuous_mountain_car:Continuous_MountainCarEnv",
        qtab="qtab.envs.classic_control:ContinuousMountainCarEnv",
        arguments=frozenset({"goal_velocity"}),
    ),
    "CartPole-v0": _CART_POLE,
    "CartPole-v1": _CART_POLE,
    "Acrobot-v1": EnvEntry("Acrobot", f"{_CLASSIC}.acrobot:AcrobotEnv", "qtab.envs.classic_control:AcrobotEnv"),
    "Pendulum-v1": EnvEntry(
        name="Pendulum",
        gymnasium=f"{_CLASSIC}.pendulum:PendulumEnv",
        qtab="qtab.envs.classic_control:PendulumEnv",
        arguments=frozenset({"g"}),
    ),
    "FrozenLake-v1": _FROZEN_LAKE,
    "FrozenLake8x8-v1": _FROZEN_LAKE,
    "CliffWalking-v1": _CLIFF,
    "CliffWalkingSlippery-v1": _CLIFF,
    "Taxi-v4": EnvEntry("Taxi", f"{_TOYS}.taxi:TaxiEnv", "qtab.envs.toy_text:TaxiEnv", has_table=True),
    "Blackjack-v1": EnvEntry(
        "Blackjack", f"{_TOYS}.blackjack:BlackjackEnv", "qtab.envs.toy_text:BlackjackEnv", has_table=True
    ),
}

EXTRA: Mapping[str, EnvEntry] = {
    f"{PREFIX}MaximizationBias-v0": EnvEntry(
        "MaximizationBias", "", "qtab.envs.maximization_bias:MaximizationBiasEnv", has_table=True
    ),
}
"""Those that Gymnasium does not have."""


def gymnasium_id(env: str) -> str:
    """Returns the id of Gymnasium's environment that an id of ours equals; any other id as it is."""
    return env.removeprefix(f"{PACKAGE}:").removeprefix(PREFIX)


def entry_for_id(env: str) -> EnvEntry | None:
    """Returns the model that an id names, ours or Gymnasium's."""
    return ENTRIES.get(gymnasium_id(env)) or EXTRA.get(env.removeprefix(f"{PACKAGE}:"))


def versioned(env: str) -> str:
    """Returns an id with its version: the newest where it names none, which ``gymnasium.make`` takes with this warning.

    Raises:
        gymnasium.error.Error: Gymnasium's own, for what is no id.
        ModuleNotFoundError: for a package that is not installed.
    """
    package, colon, name = env.rpartition(":")
    if package:
        import_module(package)
    namespace, bare, version = parse_env_id(name)
    newest = find_highest_version(namespace, bare)
    if version is not None or newest is None:
        return env
    found = get_env_id(namespace, bare, newest)
    gym.logger.warn(
        f"Using the latest versioned environment `{found}` instead of the unversioned environment `{name}`."
    )
    return f"{package}{colon}{found}"


def spec_of(env: str) -> EnvSpec:
    """Returns the spec of an id, whose package is imported where the id names it ("package:id").

    Raises:
        gymnasium.error.Error: Gymnasium's own, for an id that it does not know.
        ModuleNotFoundError: for a package that is not installed.
    """
    return gym.spec(versioned(env).rpartition(":")[2])


def entry_for_spec(spec: EnvSpec, kwargs: Mapping[str, Any]) -> EnvEntry | None:
    """Returns the model that computes what ``gymnasium.make(spec, **kwargs)`` would, or None if Rust has none."""
    model = entry_for_id(spec.id)
    if model is None or spec.additional_wrappers:
        return None
    if spec.entry_point not in (model.gymnasium, model.qtab):
        return None
    # Who asks for a window gets Gymnasium's environment, stepped in Python.
    arguments = {
        name: value for name, value in {**spec.kwargs, **kwargs}.items() if (name, value) != ("render_mode", None)
    }
    if model.has_table:
        return None if "render_mode" in arguments else model
    # A number of another width than Python's would promote differently.
    plain = all(type(value) in (int, float, bool) for value in arguments.values())
    return model if plain and arguments.keys() <= model.arguments else None

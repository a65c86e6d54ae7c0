"""The environments that Rust implements: one entry for each Gymnasium id, and the lookup of entries and specs.

Environments that a file names are used if they are registered, and never imported.
"""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec, find_highest_version, get_env_id, parse_env_id

from qtab._utils.shown import shown
from qtab.envs.origin.class_code import changed_entry_point

PACKAGE = "qtab"
PREFIX = "qtab/"
UNLIMITED_MAX_EPISODE_STEPS = 10_000
"""The time limit in training for environments that have none."""
_TABLE = "Table"
"""The name, in the extension module, of all environments that a transition table describes completely."""


@dataclass(frozen=True)
class EnvEntry:
    """An environment that Rust implements, and the Python classes whose numbers it reproduces."""

    name: str
    """The name of the environment in the extension module."""
    gymnasium_entry_point: str
    """Gymnasium's class as ``"module:Class"``; empty if Gymnasium has none."""
    entry_point: str
    """This package's class as ``"module:Class"``."""
    supported_kwargs: frozenset[str] = field(default_factory=frozenset)
    """Constructor arguments that set constants Rust computes with. With any other argument Python steps."""
    has_table: bool = False
    """Whether Rust reads a transition table or the rules from the environment object, whatever its arguments were."""
    vector_entry_point: str = ""
    """This package's twin of the vector environment that Gymnasium has for the id; empty if Gymnasium has none."""

    @property
    def knows_transitions(self) -> bool:
        """Whether all transition probabilities are known, from which :func:`qtab.optimum` computes the optimum."""
        return self.name in (_TABLE, "Blackjack", "Taxi")

    def makes(self, spec: EnvSpec) -> bool:
        """Returns whether a spec makes one of the two classes, without wrappers of its own."""
        return spec.entry_point in (self.gymnasium_entry_point, self.entry_point) and not spec.additional_wrappers


def _classic_control(name: str, gymnasium_class: str, *supported_kwargs: str, vector_entry_point: str = "") -> EnvEntry:
    return EnvEntry(
        name=name,
        gymnasium_entry_point=f"gymnasium.envs.classic_control.{gymnasium_class}",
        entry_point=f"qtab.envs.classic_control:{name}Env",
        supported_kwargs=frozenset(supported_kwargs),
        vector_entry_point=vector_entry_point,
    )


def _toy_text(class_name: str, gymnasium_class: str, name: str = _TABLE) -> EnvEntry:
    return EnvEntry(
        name=name,
        gymnasium_entry_point=f"gymnasium.envs.toy_text.{gymnasium_class}",
        entry_point=f"qtab.envs.toy_text:{class_name}",
        has_table=True,
    )


def _table(entry_point: str) -> EnvEntry:
    """Returns the entry of a function that makes a :class:`qtab.TabularEnv`."""
    return EnvEntry(_TABLE, "", entry_point, has_table=True)


_CART_POLE = _classic_control(
    "CartPole",
    "cartpole:CartPoleEnv",
    "sutton_barto_reward",
    vector_entry_point="qtab.envs.classic_control:CartPoleVectorEnv",
)

ENTRIES: Mapping[str, EnvEntry] = {
    "MountainCar-v0": _classic_control("MountainCar", "mountain_car:MountainCarEnv", "goal_velocity"),
    "MountainCarContinuous-v0": _classic_control(
        "ContinuousMountainCar", "continuous_mountain_car:Continuous_MountainCarEnv", "goal_velocity"
    ),
    "CartPole-v0": _CART_POLE,
    "CartPole-v1": _CART_POLE,
    "Acrobot-v1": _classic_control("Acrobot", "acrobot:AcrobotEnv"),
    "Pendulum-v1": _classic_control("Pendulum", "pendulum:PendulumEnv", "g"),
    "FrozenLake-v1": _toy_text("FrozenLakeEnv", "frozen_lake:FrozenLakeEnv"),
    "FrozenLake8x8-v1": _toy_text("FrozenLakeEnv", "frozen_lake:FrozenLakeEnv"),
    "CliffWalking-v1": _toy_text("CliffWalkingEnv", "cliffwalking:CliffWalkingEnv"),
    "CliffWalkingSlippery-v1": _toy_text("CliffWalkingEnv", "cliffwalking:CliffWalkingEnv"),
    "Taxi-v4": _toy_text("TaxiEnv", "taxi:TaxiEnv", "Taxi"),
    "Blackjack-v1": _toy_text("BlackjackEnv", "blackjack:BlackjackEnv", "Blackjack"),
}
"""Gymnasium's environments, by Gymnasium's id."""

_BOOK = {
    "AccessControlQueue-v0": (_TABLE, "access_control_queue:AccessControlQueueEnv"),
    "BlockingMaze-v0": ("ChangingMaze", "mazes:BlockingMazeEnv"),
    "DynaMaze-v0": (_TABLE, "mazes:DynaMazeEnv"),
    "Racetrack-v0": ("Racetrack", "racetrack:RacetrackEnv"),
    "ShortcutMaze-v0": ("ChangingMaze", "mazes:ShortcutMazeEnv"),
}
"""The names in the extension module, and the classes, of environments of Sutton & Barto's book."""

EXTRA: Mapping[str, EnvEntry] = {
    **{
        f"{PREFIX}{name}": EnvEntry(of_extension, "", f"qtab.envs.book.{entry_point}", has_table=True)
        for name, (of_extension, entry_point) in _BOOK.items()
    },
    f"{PREFIX}KArmedBandit-v0": EnvEntry(
        "KArmedBandit", "", "qtab.envs.book.k_armed_bandit:KArmedBanditEnv", has_table=True
    ),
    f"{PREFIX}MaximizationBias-v0": EnvEntry(
        "MaximizationBias", "", "qtab.envs.book.maximization_bias:MaximizationBiasEnv", has_table=True
    ),
    f"{PREFIX}ShortCorridor-v0": EnvEntry(
        "ShortCorridor", "", "qtab.envs.book.short_corridor:ShortCorridorEnv", has_table=True
    ),
    f"{PREFIX}RandomWalk-v0": _table("qtab.envs.book.random_walk:RandomWalkEnv"),
    f"{PREFIX}GridWorld5x5-v0": _table("qtab.envs.grid_worlds:grid_world_5x5"),
    f"{PREFIX}GridWorld4x4-v0": _table("qtab.envs.grid_worlds:grid_world_4x4"),
    f"{PREFIX}GamblersProblem-v0": _table("qtab.envs.book.gamblers_problem:gamblers_problem"),
    f"{PREFIX}JacksCarRental-v0": _table("qtab.envs.book.jacks_car_rental:jacks_car_rental"),
    f"{PREFIX}RandomMdp-v0": _table("qtab.envs.book.random_mdp:random_mdp"),
    f"{PREFIX}BairdCounterexample-v0": _table("qtab.envs.book.baird_counterexample:BairdCounterexampleEnv"),
    f"{PREFIX}BoyanChain-v0": _table("qtab.envs.book.boyan_chain:BoyanChainEnv"),
}
"""Environments that Gymnasium does not have, by their id."""

TABULAR = EnvEntry(_TABLE, "", "qtab.envs.tabular:TabularEnv", has_table=True)
""":class:`qtab.TabularEnv`, which has no id."""
TABULATED = "qtab.envs.tabulation.tabulated_env:TabulatedEnv"
"""The class of the tables that :func:`qtab.tabulate` makes."""


def gymnasium_id(env: str) -> str:
    """Returns the Gymnasium id that a ``qtab/`` id is the twin of; any other id unchanged."""
    return env.removeprefix(f"{PACKAGE}:").removeprefix(PREFIX)


def bare_id(env: str) -> str:
    """Returns an id as Gymnasium's registry has it, without its package and the prefix ``qtab/``, for comparisons."""
    return gymnasium_id(env.rpartition(":")[2])


def entry_for_id(env: str) -> EnvEntry | None:
    """Returns the entry of an id, Gymnasium's or this package's; None if Rust does not implement it."""
    return ENTRIES.get(gymnasium_id(env)) or EXTRA.get(env.removeprefix(f"{PACKAGE}:"))


def entry_for_spec(spec: EnvSpec, kwargs: Mapping[str, Any]) -> EnvEntry | None:
    """Returns the entry that computes the numbers of ``gymnasium.make(spec, **kwargs)``; None if there is none.

    Also None if the code of the environment's class was replaced.
    """
    entry = entry_for_id(spec.id)
    if entry is None or not entry.makes(spec):
        return None
    for name, value in {**spec.kwargs, **kwargs}.items():
        if name == "render_mode":
            if value is not None:  # Python steps it, so that it can be rendered
                return None
        # NumPy scalars would promote to other dtypes than Python numbers do.
        elif not entry.has_table and (name not in entry.supported_kwargs or type(value) not in (int, float, bool)):
            return None
    return None if changed_entry_point(str(spec.entry_point)) else entry


def versioned(env: str) -> str:
    """Returns an id with a version, the newest if it names none, with the warning that ``gymnasium.make`` gives.

    Raises:
        gymnasium.error.Error: from Gymnasium, for a malformed id.
        ModuleNotFoundError: if the id names a package (``"package:id"``) that is not installed.
    """
    package, colon, name = env.rpartition(":")
    import_package(env)
    namespace, bare_name, version = parse_env_id(name)
    newest = find_highest_version(namespace, bare_name) if version is None else None
    if newest is None:
        return env
    full_name = get_env_id(namespace, bare_name, newest)
    gym.logger.warn(
        f"Using the latest versioned environment `{full_name}` instead of the unversioned environment `{name}`."
    )
    return type(env)(f"{package}{colon}{full_name}")


def make_env(spec: EnvSpec, env_kwargs: Mapping[str, Any], **of_gymnasium: Any) -> gym.Env:
    """Returns ``gymnasium.make(spec, **env_kwargs, **of_gymnasium)``.

    Raises:
        ValueError: if the constructor raises ``LookupError`` or ``ValueError``; the message names the environment and
            ``env_kwargs``, as Gymnasium's does for ``TypeError``. Without ``env_kwargs`` errors are raised unchanged.
    """
    try:
        return gym.make(spec, **env_kwargs, **of_gymnasium)
    except (LookupError, ValueError) as error:
        if not env_kwargs:
            raise
        raise ValueError(
            f"env_kwargs must be keyword arguments that {spec.id} accepts, got {shown(dict(env_kwargs))}: {error!r}"
        ) from error


def spec_of(env: str) -> EnvSpec:
    """Returns the spec of an id; see :func:`named_spec`."""
    return named_spec(env)[1]


def named_spec(env: str) -> tuple[str, EnvSpec]:
    """Returns an id with its version, and its spec, after importing the package that the id names (``"package:id"``).

    Nothing is imported for an id that was read from a file.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        ModuleNotFoundError: if the package is not installed.
    """
    try:
        name = versioned(env)
        return name, gym.spec(name.rpartition(":")[2])
    except gym.error.UnregisteredEnv:
        if isinstance(env, StoredId):
            raise unregistered(env) from None
        raise


class StoredId(str):
    """The id of an environment that was read from a file. It equals the id as a plain string.

    Gymnasium imports ``package`` for an id such as ``"package:Name-v0"``, which would let a file choose a module. For
    an id of this class it is not imported: the environment has to be registered already.
    """

    __slots__ = ()


def stored_id(env: Any) -> Any:
    """Returns an id from a file as a :class:`StoredId` if it names a package; anything else unchanged."""
    return StoredId(env) if isinstance(env, str) and ":" in env else env


def import_package(env: str) -> None:
    """Imports the package that an id names (``"package:id"``), unless the id was read from a file.

    Raises:
        ModuleNotFoundError: if the package is not installed.
    """
    package = env.rpartition(":")[0]
    if package and not isinstance(env, StoredId):
        import_module(package)


def spec_of_run(env: str) -> EnvSpec:
    """Returns the spec of a run's environment, whose id is complete.

    Raises:
        gymnasium.error.UnregisteredEnv: if it is not registered; the message names the remedy.
        ModuleNotFoundError: if the package that the id names is not installed.
    """
    import_package(env)
    spec = gym.registry.get(env.rpartition(":")[2])
    if spec is None:
        raise unregistered(env)
    return spec


def is_registered(env: str) -> bool:
    """Returns whether the environment of a run can be made from its id."""
    with suppress(gym.error.UnregisteredEnv, ModuleNotFoundError):
        return bool(spec_of_run(env))
    return False


def unregistered(env: str) -> gym.error.UnregisteredEnv:
    """Returns the error for a run whose environment is not registered."""
    package = env.rpartition(":")[0]
    advice = f"import {package} first, or pass env=" if package else "pass env="
    return gym.error.UnregisteredEnv(f"the run's environment {str(env)!r} is not registered with Gymnasium: {advice}")


def hint_for(given: Any) -> str:
    """Returns what to write instead of a class or a function given as an environment, for the end of an error."""
    if isinstance(given, type) and issubclass(given, gym.Env):
        return f"; pass an instance, {given.__name__}()"
    if callable(given) and not isinstance(given, type):
        return "; pass the environment that it makes"
    return ""

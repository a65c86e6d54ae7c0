"""Environments that a file names: they are used if they are registered, and never imported."""

from contextlib import suppress
from importlib import import_module
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec


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

"""The capsule of an environment, by which Rust steps it."""

from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np

from qtab import _core
from qtab.envs.functional import FunctionalEnv
from qtab.envs.matching import NotInRustError, layers, unknown_wrapper


def has_capsule(env: gym.Env) -> bool:
    """Returns whether the class of an environment, without its wrappers, has the method ``__qtab_env__``."""
    return getattr(type(env.unwrapped), "__qtab_env__", None) is not None


def check_backend(env: gym.Env, backend: str) -> None:
    """Checks that Numba can compile an environment, if the backend is Numba.

    Raises:
        NotInRustError: if the environment is of another class.
    """
    if backend == "numba" and not isinstance(env.unwrapped, FunctionalEnv):
        raise NotInRustError("Numba compiles environments of the class qtab.FunctionalEnv", "derive from it")


def external_env(env: gym.Env) -> _core.ExternalEnv | None:
    """Returns an environment as Rust steps it by its capsule; None if its class has no method ``__qtab_env__``.

    The method returns the capsule ``qtab.env.1``, or raises :class:`NotInRustError` with the reason why there is none.
    If a function of the environment fails in a run, its method ``__qtab_env_failed__(state, action, rng)`` is called,
    which should repeat the call in Python to raise the error: ``state`` are the bytes of the state (None for a reset),
    ``action`` is the number of the action counted from 0 (None for a reset), and ``rng`` is a generator as it was
    before the call.

    Args:
        env: The environment, perhaps in the wrappers of ``gymnasium.make``.

    Raises:
        NotInRustError: if Rust cannot step the environment.
        TypeError: if the method returns something other than a capsule.
        ValueError: if the capsule does not hold an environment of this version, or its sizes are wrong.
    """
    if not has_capsule(env):
        return None
    unwrapped: Any = env.unwrapped
    if (wrapper := unknown_wrapper(env)) is not None:
        raise NotInRustError(
            f"Rust does not implement its wrapper {wrapper}", "pass the environment without this wrapper"
        )
    cls = type(unwrapped)
    for base in cls.__mro__[: next(i for i, base in enumerate(cls.__mro__) if "__qtab_env__" in vars(base))]:
        if (name := next((name for name in ("reset", "step") if name in vars(base)), None)) is not None:
            raise NotInRustError(f"its class {base.__name__} overrides {name}", "leave reset and step as they are")
    for layer in layers(env):
        for name in vars(layer):
            if callable(getattr(type(layer), name, None)):
                raise NotInRustError(f"its method {name} was replaced", "change the class instead")
    for name in ("observation_space", "action_space"):
        if getattr(env, name) != getattr(unwrapped, name):
            raise NotInRustError(f"its {name} was changed in a wrapper", "pass the environment without the change")
    failed = getattr(unwrapped, "__qtab_env_failed__", None)
    return _core.ExternalEnv(unwrapped.__qtab_env__(), None if failed is None else _failure_handler(failed))


def _failure_handler(failed: Callable[..., Any]) -> Callable[[bytes | None, int, int | None, int | None, int], None]:
    def handle(
        state: bytes | None, words_drawn: int, buffered_uint32: int | None, action: int | None, seed: int
    ) -> None:
        failed(state, action, generator_at(seed, words_drawn, buffered_uint32))

    return handle


def generator_at(seed: int, words_drawn: int, buffered_uint32: int | None) -> np.random.Generator:
    """Returns the generator of ``env.reset(seed=seed)`` after it has drawn some words.

    Args:
        seed: The seed.
        words_drawn: The number of 64-bit words.
        buffered_uint32: The half of the last word that was not used yet; None if there is none.
    """
    bit_generator = np.random.PCG64(seed)
    bit_generator.advance(words_drawn)
    if buffered_uint32 is not None:
        bit_generator.state = {**bit_generator.state, "has_uint32": 1, "uinteger": buffered_uint32}
    return np.random.Generator(bit_generator)

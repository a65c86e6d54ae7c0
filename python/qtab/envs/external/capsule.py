"""The capsule of an environment, by which Rust steps it."""

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import gymnasium as gym

from qtab import _core
from qtab.envs.external.positions import FailedCall, generator_at
from qtab.envs.in_rust.matching import NotInRustError, check_known_wrappers, layers, overridden
from qtab.envs.origin.class_code import is_of_library

if TYPE_CHECKING:
    from qtab.compilation.ordinary import OrdinaryEnv


def has_capsule(env: gym.Env) -> bool:
    """Returns whether the class of an environment, without its wrappers, has the method ``__qtab_env__``."""
    return getattr(type(env.unwrapped), "__qtab_env__", None) is not None


def external_env(env: gym.Env, backend: str, *, needs_masks: bool = False) -> _core.ExternalEnv | None:
    """Returns an environment as Rust steps it by its capsule; None if its class has no method ``__qtab_env__``.

    With the backend Numba, such a class is compiled from its source code.

    The method returns the capsule ``qtab.env.1``, or raises :class:`NotInRustError` with the reason why there is none.
    If a function of the environment fails in a run, its method ``__qtab_env_failed__(state, action, rng)`` is called,
    which should repeat the call in Python to raise the error: ``state`` are the bytes of the state (None for a reset),
    ``action`` is the number of the action counted from 0 (None for a reset), and ``rng`` is a generator as it was
    before the call.

    Args:
        env: The environment, perhaps in the wrappers of ``gymnasium.make``.
        backend: The backend.
        needs_masks: Whether to refuse a class that is compiled without its action masks, as these cannot be compiled.

    Raises:
        NotInRustError: if Rust cannot step the environment.
        TypeError: if the method returns something other than a capsule.
        ValueError: if the capsule does not hold an environment of this version, its sizes are wrong, or its time limit
            is not the attribute ``max_episode_steps``.
    """
    if not has_capsule(env):
        if backend != "numba":
            return None
        compiled = compiled_class(env, needs_masks)
        return external_of(compiled, partial(compiled.repeat, reads_masks=needs_masks))
    unwrapped = _unwrapped(env)
    cls = type(unwrapped)
    owner = next(base for base in cls.__mro__ if "__qtab_env__" in vars(base))
    if (found := overridden(cls, owner)) is not None:
        base, name = found
        raise NotInRustError(f"its class {base.__name__} overrides {name}", "leave reset and step as they are")
    failed = getattr(unwrapped, "__qtab_env_failed__", None)
    capsule = unwrapped.__qtab_env__()  # kept here: it must not end while an error is raised
    external = _core.ExternalEnv(capsule, None if failed is None else _failure_handler(failed))
    limit = external.max_episode_steps
    if limit is not None and (own := getattr(unwrapped, "max_episode_steps", None)) != limit:
        raise ValueError(f"max_episode_steps of the environment must be {limit}, as in its capsule, got {own}")
    return external


def compiled_class(
    env: gym.Env, needs_masks: bool, check: "Callable[[OrdinaryEnv], None] | None" = None
) -> "OrdinaryEnv":
    """Returns an ordinary Gymnasium class that is compiled by Numba from its source code.

    Args:
        env: The environment, perhaps in the wrappers of ``gymnasium.make``.
        needs_masks: Whether its action masks must be compiled too.
        check: Called with the class before it is compiled; it may raise ``NotInRustError``, too.

    Raises:
        NotInRustError: if it cannot be compiled; it gives the file, the line and what to write instead.
    """
    from qtab.compilation import NotCompilable
    from qtab.compilation.ordinary import OrdinaryEnv

    if is_of_library(type(env.unwrapped)):
        reason = "Numba compiles your own classes, derived from gymnasium.Env or qtab.FunctionalEnv"
        raise NotInRustError(reason, "leave out backend")

    def checked(one: "OrdinaryEnv") -> None:
        if needs_masks and one.rewritten.mask_refusal is not None:
            raise one.rewritten.mask_refusal
        if check is not None:
            check(one)

    try:
        return OrdinaryEnv(_unwrapped(env), _name_of(env), checked)
    except NotCompilable as refusal:
        raise NotInRustError(refusal.place_and_reason, refusal.advice, refusal.problems) from None


def external_of(env: "OrdinaryEnv", repeat: Callable[[FailedCall], Any]) -> _core.ExternalEnv:
    """Returns an ordinary class as Rust steps it.

    Args:
        env: The compiled class.
        repeat: Repeats a call in Python that failed in compiled code.
    """
    capsule = env.capsule()  # kept here: it must not end while an error is raised
    return _core.ExternalEnv(capsule, lambda *failed: repeat(FailedCall(*failed)), repeats_episodes=True)


def _name_of(env: gym.Env) -> str:
    """Returns the text of an environment, without calling a method of the user's class."""
    cls = type(env.unwrapped)
    if cls.__str__ is gym.Env.__str__ and cls.__repr__ is gym.Env.__repr__:
        return str(env)
    return cls.__name__ if env.spec is None else env.spec.id


def _unwrapped(env: gym.Env) -> Any:
    """Returns the environment without its wrappers, which must not change it."""
    unwrapped: Any = env.unwrapped
    check_known_wrappers(env)
    for layer in layers(env):
        for name in vars(layer):
            if callable(getattr(type(layer), name, None)):
                raise NotInRustError(f"its method {name} was replaced", "change the class instead")
    for name in ("observation_space", "action_space"):
        if getattr(env, name) != getattr(unwrapped, name):
            raise NotInRustError(f"its {name} was changed in a wrapper", "pass the environment without the change")
    return unwrapped


def _failure_handler(repeat: Callable[..., Any]) -> Callable[..., None]:
    def handle(*call: Any) -> None:
        failed = FailedCall(*call)
        repeat(failed.state, failed.action, generator_at(failed.seed, failed.before))

    return handle

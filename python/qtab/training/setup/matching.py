"""Finds how Rust steps the environment of a run."""

import logging
from typing import TypeAlias

import gymnasium as gym

from qtab import _core
from qtab.config import Config
from qtab.config.choices import IN_PYTHON, INSISTING
from qtab.envs.in_rust.matching import NotInRustError, entry_for_env, rust_unavailable
from qtab.envs.in_rust.native import check_not_shown
from qtab.envs.registry import EnvEntry
from qtab.training.setup.use import Use

InRust: TypeAlias = EnvEntry | _core.ExternalEnv
"""An environment that Rust steps: an entry of the registry, or that of a capsule."""
_LOGGER = logging.getLogger("qtab")


def match(
    env: gym.Env, config: Config, use: Use | None, *, is_made: bool, is_ours: bool
) -> tuple[InRust | None, str | None, bool]:
    """Returns the entry, or the capsule, of an environment that Rust can step; else None, and the reason with a remedy.

    The third result is whether the capsule is that of an ordinary class that was compiled by default.

    Args:
        env: The environment.
        config: The settings given.
        use: How the call uses the environment.
        is_made: Whether the environment was made from an id. A render mode then requests frames, which Rust cannot
            draw.
        is_ours: Whether the environment was made for this run.

    Raises:
        ValueError: if the backend is Rust, and Rust cannot step the environment.
    """
    if config.backend in IN_PYTHON:
        return None, None, False
    from qtab.envs.external.capsule import external_env

    if config.backend == "numba" and use is not None and use.resumes and use.watched is not None:
        return _resumed_in_python(env, config, NotInRustError(use.watched, ""))
    try:
        entry = external_env(env, config.backend, needs_masks=config.action_mask is True) or entry_for_env(env)
        if is_made or config.backend == "auto":
            check_not_shown(env)
    except NotInRustError as error:
        if config.backend == "numba" and use is not None and use.resumes:
            return _resumed_in_python(env, config, error)
        if config.backend in INSISTING:
            raise rust_unavailable(error, config.backend) from None
        refusal = error.with_traceback(None)  # whose frames refer to the environment
    else:
        return entry, None, False
    from qtab.training.setup.ordinary_class import compiled_by_default

    compiled, reason = compiled_by_default(env, config, use, is_ours, refusal)
    return compiled, reason, compiled is not None


def _resumed_in_python(
    env: gym.Env, config: Config, refusal: NotInRustError
) -> tuple[_core.ExternalEnv | None, str | None, bool]:
    """Returns a class of a run that was compiled by default, which Python steps here; see :func:`match`."""
    from qtab.envs.external.capsule import stepped_in_python

    try:
        stepped = stepped_in_python(env, has_action_mask=config.action_mask is True)
    except NotInRustError:
        raise rust_unavailable(refusal, config.backend) from None
    _LOGGER.warning("the run was compiled by Numba and is resumed in Python, which is much slower: %s", refusal)
    return stepped, None, False

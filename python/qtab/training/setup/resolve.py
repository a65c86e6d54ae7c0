"""Turns a user's request into a :class:`ResolvedRun`: finds the environment and fills in all defaults."""

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec

from qtab import _core, discretizers
from qtab._utils.shown import shown
from qtab.config import DEFAULTS, Config
from qtab.config.choices import IN_PYTHON, INSISTING, Backend
from qtab.config.config import replace_checked
from qtab.config.merge import config_of, naming_preset
from qtab.config.origin import Origin, copied
from qtab.config.presets import preset
from qtab.config.validation import defaults
from qtab.envs.actions import Actions, choose_actions
from qtab.envs.in_rust.matching import NotInRustError, entry_for_env, rust_unavailable, time_limit
from qtab.envs.in_rust.native import KnownTable, check_not_shown, known_table, native_env
from qtab.envs.origin.class_code import LIBRARY, is_of_library
from qtab.envs.origin.description import EnvironmentDescription, describe_entry
from qtab.envs.registry import (
    UNLIMITED_MAX_EPISODE_STEPS,
    EnvEntry,
    entry_for_spec,
    hint_for,
    make_env,
    named_spec,
)
from qtab.training.setup.environment import (
    WRITTEN_MASKS,
    Environment,
    NativeEnvironment,
    PythonEnvironment,
    check_mask_is_given,
    known_masks,
    observed_masks,
    with_discretizer,
)
from qtab.training.setup.resolved_run import ResolvedRun, derived_settings
from qtab.training.setup.spaces_fit import fit_initial_q, infer_discretizer, set_aside

READ_IN_PYTHON = "a function as the discretizer, or max_rows, reads each observation in Python"
InRust: TypeAlias = EnvEntry | _core.ExternalEnv
"""An environment that Rust steps: an entry of the registry, or that of a capsule."""
MASKS_BY_STEP = "its action masks are known only from step to step"
MASKS_MISSING = (
    "action_mask=True needs an environment with action masks: write a method action_masks(self) that returns an array "
    "of booleans, or action_mask(self, state) for a qtab.FunctionalEnv; or give action_mask=f, a function of the "
    "observation"
)


@dataclass(frozen=True)
class _Request:
    """An environment, and the settings requested for it."""

    env: gym.Env
    entry: InRust | None
    """The environment that Rust may step instead."""
    config: Config
    """The settings given, over those of the preset: checked, not yet complete."""
    asked: Mapping[str, Any]
    """The settings given, without the preset."""
    time_limit: int | None
    """The time limit of the environment, in steps."""
    python_reason: str | None = None
    """The reason why an environment object is stepped in Python although this was not requested, and a remedy."""
    spec: EnvSpec | None = None
    """The spec of an environment that was made here."""

    def description(self) -> EnvironmentDescription:
        """Describes the environment, before anything steps it."""
        entry, spec, kwargs = self.entry, self.spec, self.config.env_kwargs
        if isinstance(entry, EnvEntry) and spec is not None and entry.makes(spec):
            if isinstance(self.env, KnownTable):
                return describe_entry(entry, spec, kwargs, self.env, spec.max_episode_steps)
            if not entry.has_table:
                limit = self.config.max_episode_steps or spec.max_episode_steps
                return describe_entry(entry, spec, kwargs, self.env, limit)
        from qtab.envs.origin.describe import describe

        # An environment stepped in Rust has its library's code, as was just checked.
        is_checked = isinstance(entry, EnvEntry) and is_of_library(type(self.env.unwrapped))
        return describe(self.env, is_new=self.spec is not None, code=LIBRARY if is_checked else None)


def resolve(
    env: str | EnvSpec | gym.Env | partial[gym.Env], *layers: Mapping[str, Any], owns_env: bool = False
) -> ResolvedRun:
    """Finds the environment and fills in all defaults.

    Args:
        env: An environment's id, its EnvSpec, an environment, or a function that makes it for this run.
        *layers: Settings by field name; later layers override earlier ones, and all override the preset.
        owns_env: Whether to close an environment that is given, with the run, or at once if it is not needed. An
            environment made here is always closed.

    Raises:
        gymnasium.error.Error: raised by Gymnasium for an unknown environment id.
        TypeError: if ``env`` has the wrong type, or a setting is unknown or has the wrong type.
        ValueError: if a setting is out of range, or the backend or a space does not fit.
    """
    asked: dict[str, Any] = {}
    for layer in layers:
        asked.update(layer)
    with ExitStack() as on_exit:
        if isinstance(env, partial):
            env, owns_env = env(), True
        if isinstance(env, gym.Env):
            if owns_env:
                on_exit.callback(env.close)
            request = _from_env(env, asked)
        elif isinstance(env, str | EnvSpec):
            request = _from_spec(env, asked)
            owns_env = True
            on_exit.callback(request.env.close)
        else:
            expected = "an environment id, an EnvSpec or an environment"
            raise TypeError(f"env must be {expected}, got {shown(env)}{hint_for(env)}")
        run = _fill_defaults(request, owns_env)
        if not run.is_native:
            on_exit.pop_all()  # the run closes the environment
    return run


def _from_spec(env: str | EnvSpec, asked: Mapping[str, Any]) -> _Request:
    # The id keeps its package, so that the config can make the environment anywhere.
    name, spec = (env.id, env) if isinstance(env, EnvSpec) else named_spec(env)
    asked = {"env_kwargs": dict(spec.kwargs), **asked}
    config = config_of(name, asked)
    entry: InRust | None = None if config.backend == "numba" else entry_for_spec(spec, config.env_kwargs)
    known, python_reason = None, None
    if entry is not None and config.backend not in IN_PYTHON and config.action_mask is False:
        known = known_table(spec, config.env_kwargs)
    made = _make(spec, config) if known is None else known
    own_limit = spec.max_episode_steps
    if entry is None:
        try:
            entry, python_reason = _match(made, config, is_made=True)
        except ValueError:
            made.close()
            raise
        # Its class, or the function that makes it, may have a limit of its own.
        config, own_limit = _within_limit(config, time_limit(made))
    return _Request(made, entry, config, asked, own_limit, python_reason, spec)


def _within_limit(config: Config, limit: int | None) -> tuple[Config, int | None]:
    """Returns the config with a time limit of at most that of the environment, and the latter."""
    if limit is not None and config.max_episode_steps is not None:  # it ends episodes there, whatever the settings
        config = replace_checked(config, max_episode_steps=min(limit, config.max_episode_steps))
    return config, limit


def _match(env: gym.Env, config: Config, *, is_made: bool) -> tuple[InRust | None, str | None]:
    """Returns the entry, or the capsule, of an environment that Rust can step; else None, and the reason with a remedy.

    Args:
        env: The environment.
        config: The settings given.
        is_made: Whether the environment was made from an id. A render mode then requests frames, which Rust cannot
            draw.

    Raises:
        ValueError: if the backend is Rust, and Rust cannot step the environment.
    """
    if config.backend in IN_PYTHON:
        return None, None
    from qtab.envs.external.capsule import external_env

    try:
        entry = external_env(env, config.backend, needs_masks=config.action_mask is True) or entry_for_env(env)
        if is_made or config.backend == "auto":
            check_not_shown(env)
    except NotInRustError as error:
        if config.backend in INSISTING:
            raise rust_unavailable(error, config.backend) from None
        return None, f"{error}; {error.remedy}" if error.remedy else str(error)
    return entry, None


def _make(spec: EnvSpec, config: Config) -> gym.Env:
    limit: dict[str, Any] = {}
    if config.max_episode_steps is not None:
        limit["max_episode_steps"] = config.max_episode_steps
    return make_env(spec, config.env_kwargs, **limit)


def _from_env(env: gym.Env, asked: Mapping[str, Any]) -> _Request:
    name = env.spec.id if env.spec is not None else type(env.unwrapped).__name__
    kwargs = dict(env.spec.kwargs) if env.spec is not None else {}
    if asked.get("env_kwargs"):
        raise ValueError(f"env_kwargs must be left out with an environment object, got {shown(asked['env_kwargs'])}")
    asked = {**asked, "env_kwargs": kwargs}
    config = config_of(name, asked)
    entry, python_reason = _match(env, config, is_made=False)
    config, limit = _within_limit(config, time_limit(env))
    return _Request(env, entry, config, asked, limit, python_reason)


def _fill_defaults(request: _Request, owns_env: bool) -> ResolvedRun:
    env, description = request.env, request.description()
    config = set_aside(env, request.config, request.asked)
    config = infer_discretizer(env.observation_space, config, request.asked)
    config = replace_checked(config, **defaults(vars(config)))
    own_limit = config.max_episode_steps or request.time_limit
    max_episode_steps = own_limit or UNLIMITED_MAX_EPISODE_STEPS
    config = replace_checked(config, max_episode_steps=max_episode_steps)
    actions = choose_actions(env.action_space, config.actions)
    environment, python_reason = _environment(request, actions, owns_env)
    try:
        discretizer = discretizers.build(env.observation_space, config, len(actions))
    except ValueError as error:
        of_preset = preset(config.env, config.preset)[1] if config.preset else {}
        used = {name for name in of_preset if getattr(config, name) is not DEFAULTS[name]}
        raise naming_preset(error, config.preset, used, request.asked) from None
    in_python = discretizer.reads_space
    if in_python:
        environment, in_python = with_discretizer(environment, discretizer)
    masks, has_masks = None, config.action_mask is not False
    if has_masks:
        check_mask_is_given(config.action_mask)
    in_rust = isinstance(environment, NativeEnvironment)
    external = request.entry if isinstance(request.entry, _core.ExternalEnv) else None
    if in_rust and has_masks and config.action_mask is True and external is not None:
        masks = WRITTEN_MASKS if external.has_action_mask else None
    elif in_rust and has_masks and not in_python:
        masks = known_masks(config.action_mask, env, discretizer, len(actions))
    if in_rust and (in_python or (has_masks and masks is None)):
        in_rust, python_reason = False, READ_IN_PYTHON if in_python else MASKS_BY_STEP
        if config.backend in INSISTING:
            if external is not None and config.action_mask is True and not in_python:
                raise ValueError(MASKS_MISSING)
            raise rust_unavailable(python_reason, config.backend)
    if has_masks and masks is None:
        masks = observed_masks(config.action_mask, env)
    if not in_rust:
        if isinstance(env, KnownTable) and request.spec is not None:
            env = _make(request.spec, request.config)
        environment = PythonEnvironment(env, actions, owns_env, masks)
    seed = int(np.random.SeedSequence().generate_state(1)[0]) if config.seed is None else config.seed
    config = replace_checked(
        config,
        **discretizer.settings(),
        initial_q=fit_initial_q(config, discretizer, len(actions)),
        seed=seed,
        backend="gymnasium" if not in_rust else "rust" if external is None else _backend_of(env),
    )
    origin = Origin(description, derived_settings(request.config, config, discretizer))
    return ResolvedRun(
        config=copied(config, origin),
        environment=environment,
        discretizer=discretizer,
        actions=actions,
        masks=masks,
        seed=seed,
        max_episode_steps=max_episode_steps,
        default_time_limit=own_limit is None,
        python_reason=python_reason,
    )


def _environment(request: _Request, actions: Actions, owns_env: bool) -> tuple[Environment, str | None]:
    """Returns the environment for Rust if Rust can step it and the backend allows it; else for Python, and why."""
    entry, backend, reason = request.entry, request.config.backend, request.python_reason
    if entry is not None and backend not in IN_PYTHON:
        try:
            if isinstance(entry, _core.ExternalEnv):
                return NativeEnvironment(entry.native_env(), entry), None
            return NativeEnvironment(native_env(entry.name, request.env.unwrapped, actions)), None
        except (TypeError, ValueError) as error:
            if backend in INSISTING:
                raise rust_unavailable(str(error), backend) from None
            reason = str(error)
    return PythonEnvironment(request.env, actions, owns_env), reason


def _backend_of(env: gym.Env) -> Backend:
    """Returns the backend of an environment with a capsule: Numba for an ordinary class, which it has compiled."""
    from qtab.envs.external.capsule import has_capsule

    return "rust" if has_capsule(env) else "numba"

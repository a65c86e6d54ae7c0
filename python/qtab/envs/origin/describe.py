"""Describes an environment in its current state."""

import hashlib
import inspect
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing
from dataclasses import replace
from itertools import chain
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.utils import RecordConstructorArgs
from gymnasium.wrappers import (
    HumanRendering,
    OrderEnforcing,
    PassiveEnvChecker,
    RecordEpisodeStatistics,
    RecordVideo,
    RenderCollection,
)
from gymnasium.wrappers import TimeLimit as TimeLimitWrapper

from qtab.envs.in_rust.matching import layers, time_limit
from qtab.envs.origin.class_code import class_code, is_of_library, state_attributes
from qtab.envs.origin.description import (
    UNIMPORTANT,
    EnvironmentDescription,
    WrapperDescription,
    constants_of,
    without_rendering,
)
from qtab.envs.origin.values import describe_value, describe_values, is_plain, same, space_text
from qtab.envs.registry import EnvEntry, entry_for_id

NEUTRAL = (
    *(OrderEnforcing, PassiveEnvChecker, TimeLimitWrapper, RecordEpisodeStatistics, RecordVideo),
    *(HumanRendering, RenderCollection),
)
"""Wrappers that change no observation, reward or end of an episode; the time limit is described separately."""
_BESIDE_TABLE = {"fickle_passenger": False, "fickle_probability": 0.3}
"""The attributes that Taxi's steps read besides the table, with the defaults of its constructor."""
_PROBE_STEPS = 50


def describe(env: gym.Env, *, is_new: bool = False, code: str | None = None) -> EnvironmentDescription:
    """Describes an environment. It is not stepped.

    Args:
        env: The environment.
        is_new: Whether it is as ``gymnasium.make`` returned it, so that nothing can have been changed.
        code: The digest of the code of its class, if that is known already.
    """
    unwrapped: Any = env.unwrapped
    cls, spec = type(unwrapped), unwrapped.spec
    entry = None if spec is None else entry_for_id(spec.id)
    kwargs = {} if spec is None else without_rendering(spec.kwargs)
    attributes = _attributes(unwrapped, entry)
    table = None
    if _has_table(unwrapped) and (not is_new or _draws_table(spec)):
        table = _changed_table(unwrapped)
    is_described = entry is not None and is_of_library(cls) and (_has_table(unwrapped) or not entry.has_table)
    if not (is_new or is_described or spec is None):
        attributes |= _changed(unwrapped, attributes)
    return EnvironmentDescription(
        id=None if spec is None else spec.id,
        cls=f"{cls.__module__}:{cls.__qualname__}",
        code=_code(unwrapped) if code is None else code,
        kwargs=describe_values(kwargs),
        wrappers=tuple(_wrapper(layer) for layer in layers(env) if _counts(layer)),
        attributes=attributes,
        table=table,
        observation_space=space_text(env.observation_space),
        action_space=space_text(env.action_space),
        max_episode_steps=time_limit(env),
    )


def _code(unwrapped: Any) -> str | None:
    """Returns a digest of the code of an environment: of its library, or of its class."""
    from qtab.envs.external.native_env import NativeEnv

    return unwrapped.code_digest if isinstance(unwrapped, NativeEnv) else class_code(type(unwrapped))


def _counts(layer: gym.Env) -> bool:
    """Returns whether a layer is a wrapper that may change a number, as any subclass of a known one may."""
    return isinstance(layer, gym.Wrapper) and type(layer) not in NEUTRAL


def _wrapper(layer: gym.Env) -> WrapperDescription:
    cls = type(layer)
    kwargs = _constructor_kwargs(layer)
    return WrapperDescription(
        cls=f"{cls.__module__}:{cls.__qualname__}",
        code=class_code(cls),
        kwargs=None if kwargs is None else describe_values(kwargs),
        attributes={**_scalars(layer), **_arguments(layer), **_replaced_methods(layer)},
    )


def _constructor_kwargs(layer: Any) -> dict[str, Any] | None:
    """Returns the arguments that a wrapper was made with; None if they are not known."""
    if isinstance(layer, RecordConstructorArgs):
        recorded = {name: value for name, value in layer._saved_kwargs.items() if name != "env"}
        if _takes(type(layer), recorded):  # otherwise they are those of a base class
            return recorded
    return {} if len(_parameters(type(layer))) == 1 else None


def _takes(cls: type, kwargs: Mapping[str, Any]) -> bool:
    try:
        inspect.signature(cls).bind(None, **kwargs)
    except (TypeError, ValueError):
        return False
    return True


def _scalars(layer: Any) -> dict[str, Any]:
    """Returns the numbers and texts that a wrapper holds and does not change itself."""
    held = {
        name: value
        for name, value in vars(layer).items()
        if not name.startswith("_") and name not in UNIMPORTANT and isinstance(value, bool | int | float | str)
    }
    state = state_attributes(type(layer)) if held else set()
    return {name: describe_value(value) for name, value in held.items() if name not in state}


def _attributes(unwrapped: Any, entry: EnvEntry | None) -> dict[str, Any]:
    replaced = _replaced_methods(unwrapped)
    if entry is not None and is_of_library(type(unwrapped)):
        if entry.has_table:
            return _beside_table(unwrapped) | replaced
        return constants_of(entry, unwrapped) | replaced
    described_apart = ("P", "initial_state_distrib") if _has_table(unwrapped) else ()
    return {name: value for name, value in _arguments(unwrapped).items() if name not in described_apart} | replaced


def _beside_table(unwrapped: Any) -> dict[str, Any]:
    """Returns the attributes that Taxi's steps read besides the table, if not as given to the constructor."""
    given = {**_BESIDE_TABLE, **(unwrapped.spec.kwargs if unwrapped.spec is not None else {})}
    held = {name: value for name, value in vars(unwrapped).items() if name in _BESIDE_TABLE}
    return {name: describe_value(value) for name, value in held.items() if value != given[name]}


def _arguments(layer: Any) -> dict[str, Any]:
    """Returns the attributes with the names of constructor arguments, which most classes keep there, but no state."""
    held = vars(layer)
    names = [name for name in _parameters(type(layer)) if name != "env" and name not in UNIMPORTANT]
    keys = {key: name for name in names for key in (name, f"_{name}") if key in held}
    state = state_attributes(type(layer)) if keys else set()
    return {name: describe_value(held[key]) for key, name in keys.items() if key not in state}


def _parameters(cls: type) -> list[str]:
    """Returns the names of the constructor's parameters; none if they cannot be known."""
    try:
        return list(inspect.signature(cls).parameters)
    except (TypeError, ValueError):
        return []


def _replaced_methods(layer: gym.Env) -> dict[str, Any]:
    return {
        name: describe_value(value) for name, value in vars(layer).items() if callable(getattr(type(layer), name, None))
    }


def _changed(unwrapped: Any, known_already: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the attributes that differ from those of a new environment of the id and do not change in steps."""
    left_out = {*known_already, *state_attributes(type(unwrapped))}
    held = {name: value for name, value in _plain_attributes(unwrapped) if name not in left_out}
    try:
        with _new(unwrapped) as new:
            # Described now, since steps may change an array or a list in place.
            made = describe_values(dict(_plain_attributes(new)))
            names = [name for name in held if name in made and not same(describe_value(held[name]), made[name])]
            moving = _moving(new, made) if names else set()
    except Exception:  # a constructor or a step of any package may raise any error
        return {}
    return {name: describe_value(held[name]) for name in names if name not in moving}


def _new(unwrapped: Any) -> "closing[Any]":
    spec = replace(unwrapped.spec, kwargs=without_rendering(unwrapped.spec.kwargs))
    return closing(gym.make(spec).unwrapped)


def _plain_attributes(unwrapped: Any) -> Iterator[tuple[str, Any]]:
    for name, value in vars(unwrapped).items():
        if not name.startswith("_") and name not in UNIMPORTANT and is_plain(value):
            yield name, value


def _moving(env: Any, before: Mapping[str, Any]) -> set[str]:
    """Returns the attributes that resets and random steps change, such as arrays in place: state, not the problem."""
    moving: set[str] = set()
    env.action_space.seed(0)
    for seed in (0, 1):
        env.reset(seed=seed)
        for _ in range(_PROBE_STEPS):
            _, _, terminated, truncated, _ = env.step(env.action_space.sample())
            now = vars(env)
            moving |= {
                name for name, value in before.items() if name not in now or not same(describe_value(now[name]), value)
            }
            if terminated or truncated:
                break
    return moving


def _has_table(unwrapped: Any) -> bool:
    """Returns whether an environment has a transition table as Gymnasium's have, and not another attribute ``P``."""
    try:
        return len(unwrapped.P[0][0][0]) == 4
    except (AttributeError, LookupError, TypeError):
        return False


def _draws_table(spec: EnvSpec | None) -> bool:
    """Returns whether the constructor draws a table, as FrozenLake's does without a map or the name of one."""
    kwargs: Mapping[str, Any] = {} if spec is None else spec.kwargs
    return "map_name" in kwargs and kwargs["map_name"] is None and kwargs.get("desc") is None


def _changed_table(unwrapped: Any) -> str | None:
    """Returns a digest of a transition table; None if it is that of a new environment of the same id."""
    table = _table_digest(unwrapped)
    if unwrapped.spec is not None:
        try:
            with _new(unwrapped) as new:
                if _table_digest(new) == table:
                    return None
        except Exception:  # a constructor of any package may raise any error
            return table
    return table


def _table_digest(unwrapped: Any) -> str | None:
    """Returns a digest of the transitions and of the first states; None if these are not all numbers."""
    states = _items(unwrapped.P)
    pairs = [(state, action, len(outcomes), outcomes) for state, row in states for action, outcomes in _items(row)]
    first = getattr(unwrapped, "initial_state_distrib", ())
    transitions = chain.from_iterable(chain.from_iterable(outcomes for *_, outcomes in pairs))
    numbers = [chain.from_iterable(pair[:3] for pair in pairs), transitions, first]
    digest = hashlib.sha256()
    try:
        for part in numbers:
            digest.update(np.fromiter(part, np.float64).tobytes() + b";")
    except (TypeError, ValueError):
        return None
    return digest.hexdigest()[:32]


def _items(table: Any) -> Iterable[tuple[Any, Any]]:
    return table.items() if isinstance(table, Mapping) else enumerate(table)

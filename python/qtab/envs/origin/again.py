"""Makes an environment again from its description."""

import sys
from collections.abc import Mapping
from contextlib import ExitStack
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec
from gymnasium.wrappers import NormalizeObservation, NormalizeReward

from qtab.envs.origin.describe import NEUTRAL, describe
from qtab.envs.origin.description import EnvironmentDescription, WrapperDescription, differences
from qtab.envs.origin.values import NotRestorableError, in_words, restored, same
from qtab.envs.registry import make_env


def needs_object(description: EnvironmentDescription, spec: EnvSpec) -> bool:
    """Returns whether an id and its arguments certainly cannot make an environment again.

    Args:
        description: The description.
        spec: The spec of its id in this process.
    """
    return description.table is not None or len(description.wrappers) != len(spec.additional_wrappers)


def make_again(
    description: EnvironmentDescription, spec: EnvSpec, kwargs: Mapping[str, Any], max_episode_steps: int | None
) -> gym.Env:
    """Makes an environment as it was described, with its wrappers and its changed attributes.

    A description may come from a file: no module is imported because it names one, except for Gymnasium's.

    Args:
        description: The description.
        spec: The spec of its id.
        kwargs: Keyword arguments of the constructor: those described, and perhaps a ``render_mode``.
        max_episode_steps: The time limit, in steps.

    Raises:
        ValueError: if a part of it is not known well enough, or the new environment differs. The message names the
            difference, and asks for ``env=``.
    """
    if description.table is not None:
        raise cannot_be_made(description, "its constructor makes another transition table")
    with ExitStack() as on_error:
        env = make_env(spec, kwargs, max_episode_steps=max_episode_steps, disable_env_checker=True)
        on_error.callback(env.close)
        try:
            env = _wrapped(env, description)
            is_new = not _set_attributes(env.unwrapped, description)
        except NotRestorableError as error:
            raise cannot_be_made(description, str(error)) from None
        found = differences(description, describe(env, is_new=is_new))
        if found:
            raise cannot_be_made(description, "; ".join(found))
        on_error.pop_all()
    return env


def cannot_be_made(description: EnvironmentDescription, reason: str) -> ValueError:
    """Returns the error for an environment that cannot be made again."""
    return ValueError(f"env must be given: the environment {description.name} cannot be made as it was: {reason}")


def _wrapped(env: gym.Env, description: EnvironmentDescription) -> gym.Env:
    """Adds the wrappers that ``gymnasium.make`` did not add."""
    made = describe(env, is_new=True).wrappers
    wanted = description.wrappers
    if made:
        if [one.name for one in wanted[-len(made) :]] != [one.name for one in made]:
            return env  # which differs, and is refused
        wanted = wanted[: -len(made)]
    for wrapper in reversed(wanted):
        if wrapper.kwargs is None:
            raise NotRestorableError(f"the arguments of its wrapper {wrapper.name} are not known")
        try:
            kwargs = {name: restored(value) for name, value in wrapper.kwargs.items()}
        except NotRestorableError as error:
            raise NotRestorableError(f"its wrapper {wrapper.name} was made with {error}") from None
        cls = _class_of(wrapper)
        if issubclass(cls, NormalizeObservation | NormalizeReward):
            raise NotRestorableError(f"its wrapper {wrapper.name} keeps running statistics, which a run does not store")
        try:
            env = cls(env, **kwargs)
        except TypeError as error:
            raise NotRestorableError(f"its wrapper {wrapper.name} no longer takes its arguments: {error}") from None
    return env


def _class_of(wrapper: WrapperDescription) -> Any:
    module_name, _, name = wrapper.cls.partition(":")
    found: Any = gym.wrappers if module_name.startswith("gymnasium.wrappers") else sys.modules.get(module_name)
    for part in name.split("."):
        found = getattr(found, part, None)
    if not (isinstance(found, type) and issubclass(found, gym.Wrapper)):
        raise NotRestorableError(f"its wrapper {wrapper.cls} is not a class of an imported module")
    if issubclass(found, NEUTRAL):  # not described: only a crafted file names one, and RecordVideo writes files
        raise NotRestorableError(f"its wrapper {wrapper.cls} is not one that a run stores")
    return found


def _set_attributes(unwrapped: Any, description: EnvironmentDescription) -> list[str]:
    """Sets the attributes that differ; returns their names."""
    here = describe(unwrapped, is_new=True).attributes
    differ = [name for name, value in description.attributes.items() if name not in here or not same(here[name], value)]
    for name in differ:
        value = description.attributes[name]
        target = name if hasattr(unwrapped, name) else f"_{name}"
        try:
            known = restored(value)
            if callable(getattr(unwrapped, target)):
                raise NotRestorableError(in_words(value))
            setattr(unwrapped, target, known)
        except (AttributeError, NotRestorableError, TypeError):
            raise NotRestorableError(f"its attribute {name} was {in_words(value)}") from None
    return differ

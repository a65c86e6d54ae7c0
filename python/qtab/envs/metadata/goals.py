"""The meaning of returns in an environment: the threshold at which it is solved, and the best known return."""

import inspect
from collections.abc import Iterator, Mapping
from contextlib import closing
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec, load_env_creator

from qtab.config import Config
from qtab.config.choices import IN_PYTHON
from qtab.config.origin import trained_on
from qtab.envs.origin.class_code import LIBRARY
from qtab.envs.origin.describe import describe
from qtab.envs.origin.description import EnvironmentDescription, WrapperDescription
from qtab.envs.origin.values import are_comparable, same
from qtab.envs.registry import UNLIMITED_MAX_EPISODE_STEPS, entry_for_id, gymnasium_id, is_registered, make_env

BEST_KNOWN_MOUNTAIN_CAR = -97.668
"""The expected return that ``qtab.optimum("MountainCar-v0")`` finds in seconds."""
MAX_QUICK_UPDATES = 10**8
"""The optimum of a table is computed if it needs at most this many updates, which take less than a second."""


def reward_threshold(
    env: str,
    env_kwargs: Mapping[str, Any],
    max_episode_steps: int | None,
    description: EnvironmentDescription | None = None,
) -> float | None:
    """Returns the return at which Gymnasium considers an environment solved; None if it gives none.

    The threshold applies to the environment as it is registered: with another time limit, other keyword arguments,
    wrappers or attributes the same return has another meaning.

    Args:
        env: The id.
        env_kwargs: The keyword arguments of its constructor.
        max_episode_steps: The time limit, in steps.
        description: The environment in detail; None if it is not known.
    """
    spec = _registered(env)
    if spec is None or spec.reward_threshold is None:
        return None
    return None if _why_not_as_registered(spec, env_kwargs, max_episode_steps, description) else spec.reward_threshold


def threshold_of(config: Config) -> float | None:
    """Returns the threshold that applies to the config of a run; see :func:`reward_threshold`."""
    return reward_threshold(config.env, config.env_kwargs, config.max_episode_steps, trained_on(config))


def registered_threshold(env: str) -> float | None:
    """Returns the threshold of an environment as it is registered; None if it has none."""
    spec = _registered(env)
    return None if spec is None else spec.reward_threshold


def why_no_threshold(config: Config) -> str:
    """Returns the reason why no threshold applies to the config of a run."""
    spec = _registered(config.env)
    if spec is None or spec.reward_threshold is None:
        return "Gymnasium defines no threshold"
    reason = _why_not_as_registered(spec, config.env_kwargs, config.max_episode_steps, trained_on(config))
    return f"Gymnasium's threshold of {spec.reward_threshold:g} {reason}"


def is_usual_mountain_car(config: Config) -> bool:
    """Returns whether a run is on MountainCar-v0 with the default constants and time limit."""
    return gymnasium_id(config.env) == "MountainCar-v0" and threshold_of(config) is not None


def has_quick_optimum(config: Config, n_rows: int, n_actions: int) -> bool:
    """Returns whether the optimum of a resolved config's environment is computed in less than a second.

    Args:
        config: The config.
        n_rows: The number of rows of the run's table.
        n_actions: The number of actions.
    """
    entry = entry_for_id(config.env)
    if config.backend in IN_PYTHON or entry is None or not entry.knows_transitions or not is_registered(config.env):
        return False
    steps = 1 if config.time_aware else config.max_episode_steps or 0  # a time-aware table has rows for each step
    return n_rows * n_actions * steps <= MAX_QUICK_UPDATES


def own_time_limit(env: str) -> int | None:
    """Returns the time limit with which an environment is registered; None if it has none."""
    spec = _registered(env)
    return None if spec is None else spec.max_episode_steps


def _registered(env: str) -> EnvSpec | None:
    """Returns the spec of a complete id. Nothing is imported: the id may come from a file."""
    return gym.registry.get(env.rpartition(":")[2])


def _why_not_as_registered(
    spec: EnvSpec,
    env_kwargs: Mapping[str, Any],
    max_episode_steps: int | None,
    description: EnvironmentDescription | None,
) -> str | None:
    """Returns the reason why the threshold of a spec does not apply, to follow its number; None if it does."""
    limit = spec.max_episode_steps or UNLIMITED_MAX_EPISODE_STEPS
    if max_episode_steps != limit:
        return f"holds for {limit:,} steps, not for max_episode_steps={max_episode_steps}"
    if not _has_usual_arguments(spec, env_kwargs):
        return "does not hold for other env_kwargs"
    change = None if description is None else what_changes_returns(description, spec, env_kwargs)
    return None if change is None else f"does not hold for the returns of this environment: {change}"


def _has_usual_arguments(spec: EnvSpec, env_kwargs: Mapping[str, Any]) -> bool:
    own = {**spec.kwargs, "render_mode": None}
    others = {name: value for name, value in env_kwargs.items() if name not in own}
    if others:
        own |= _constructor_defaults(spec)
    return all(
        name == "render_mode" or (name in own and _equal(value, own[name])) for name, value in env_kwargs.items()
    )


def _constructor_defaults(spec: EnvSpec) -> dict[str, Any]:
    """Returns the defaults of the constructor's arguments, for environments whose class is known."""
    entry = entry_for_id(spec.id)
    if entry is None:
        return {}
    parameters = inspect.signature(load_env_creator(entry.gymnasium_entry_point or entry.entry_point)).parameters
    return {name: value.default for name, value in parameters.items() if name not in spec.kwargs}


def _equal(one: Any, other: Any) -> bool:
    try:
        return bool(one == other)
    except ValueError:  # arrays
        return False


_TRANSLATING = ("gymnasium.wrappers.transform_observation", "gymnasium.wrappers.transform_action")
"""The modules of wrappers that only change how observations and actions are represented."""


def what_changes_returns(
    description: EnvironmentDescription, spec: EnvSpec, env_kwargs: Mapping[str, Any]
) -> str | None:
    """Returns the reason why the returns of an environment do not compare with those of the registered one.

    Args:
        description: The environment.
        spec: The spec of its id. Its environment is made only if the description has something to compare.
        env_kwargs: The keyword arguments of the constructor.

    Returns:
        The reason, to follow a colon; None if there is none.
    """
    if description.table is not None:
        return "its transition table was changed"
    if description.code != LIBRARY and description.cls.startswith(("gymnasium.", "qtab.")):
        return f"methods of its class {description.cls.rpartition(':')[2]} were replaced"
    registered = None
    if description.code != LIBRARY or description.attributes or spec.additional_wrappers:
        try:
            with closing(make_env(spec, env_kwargs, disable_env_checker=True)) as env:
                registered = describe(env, is_new=True)
        except Exception as error:  # a constructor of any package may raise any error
            return f"the registered environment cannot be made to compare it ({type(error).__name__})"
    return next(_changes(description, registered), None)


def _changes(ours: EnvironmentDescription, registered: EnvironmentDescription | None) -> Iterator[str]:
    around, usual = _wrappers(ours), () if registered is None else _wrappers(registered)
    if not same([[one.cls, one.kwargs] for one in around], [[one.cls, one.kwargs] for one in usual]):
        yield f"it has {_listed(around)}" + (f", not {_listed(usual)}" if usual else "")
    if registered is None:
        return
    if ours.code != registered.code and (
        LIBRARY in (ours.code, registered.code) or are_comparable(ours.code, registered.code)
    ):
        yield "the code of its class is different"
    for name in sorted(ours.attributes.keys() | registered.attributes.keys()):
        both = name in ours.attributes and name in registered.attributes
        if not both or not same(ours.attributes[name], registered.attributes[name]):
            yield f"its attribute {name} was changed"


def _wrappers(description: EnvironmentDescription) -> tuple[WrapperDescription, ...]:
    """Returns the wrappers that may change rewards or the result of a step."""
    return tuple(wrapper for wrapper in description.wrappers if not _only_translates(wrapper))


def _listed(wrappers: tuple[WrapperDescription, ...]) -> str:
    names = ", ".join(wrapper.name for wrapper in wrappers)
    return f"the wrapper{'s' if len(wrappers) > 1 else ''} {names}" if wrappers else "no wrapper"


def _only_translates(wrapper: WrapperDescription) -> bool:
    is_replaced = wrapper.code != LIBRARY or not wrapper.attributes.keys().isdisjoint(("step", "reset"))
    return wrapper.cls.partition(":")[0] in _TRANSLATING and not is_replaced

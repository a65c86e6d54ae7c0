"""Compares the environment of a run with the registered one, as far as the meaning of its returns is concerned."""

from collections.abc import Iterator, Mapping
from contextlib import closing
from typing import Any

from gymnasium.envs.registration import EnvSpec

from qtab.envs.class_code import LIBRARY
from qtab.envs.origin.describe import describe
from qtab.envs.origin.description import EnvironmentDescription, WrapperDescription
from qtab.envs.origin.values import comparable, same
from qtab.envs.registry import make_env

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
        LIBRARY in (ours.code, registered.code) or comparable(ours.code, registered.code)
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

"""The description of an environment that a run was trained on, and its differences from another environment."""

import logging
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, TypeVar

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec

from qtab._core import parameter_names
from qtab.envs.origin.class_code import LIBRARY
from qtab.envs.origin.values import are_comparable, describe_values, in_words, same, space_text, without_digest
from qtab.envs.registry import EnvEntry, bare_id

UNIMPORTANT = ("render_mode", "spec", "metadata")
"""Attributes of environments that change no number."""


@dataclass(frozen=True)
class WrapperDescription:
    """A wrapper around an environment, with values as :func:`qtab.envs.origin.values.describe_value` returns them."""

    cls: str
    """Its class as ``"module:Class"``."""
    code: str | None
    """A digest of the code of its class; None if it is not known."""
    kwargs: Mapping[str, Any] | None
    """The arguments that it was made with; None if they are not known."""
    attributes: Mapping[str, Any]
    """The attributes that it does not change itself: numbers, texts, those with the names of constructor arguments, and
    methods replaced on the object."""

    @property
    def name(self) -> str:
        """The name of the class."""
        return self.cls.rpartition(":")[2]


@dataclass(frozen=True)
class EnvironmentDescription:
    """The parts of an environment, described once when training begins.

    Its values are those of :func:`qtab.envs.origin.values.describe_value`, which JSON can hold.
    """

    id: str | None
    """The id under which Gymnasium makes it; None for an environment without one."""
    cls: str
    """The class of the environment without its wrappers, as ``"module:Class"``."""
    code: str | None
    """A digest of the code of the class; None if it is not known."""
    kwargs: Mapping[str, Any]
    """The arguments of the constructor, without ``render_mode``; none are known without an id."""
    wrappers: tuple[WrapperDescription, ...]
    """The wrappers that can change a number, the outermost first."""
    attributes: Mapping[str, Any]
    """Attributes that make a difference: the constants of Gymnasium's classic control, the attributes with the names of
    constructor arguments, those changed after the constructor, and methods replaced on the object."""
    table: str | None
    """A digest of the transition table; None without one, or if it is as the constructor makes it."""
    observation_space: str
    """The observation space that training sees, with a digest of its bounds."""
    action_space: str
    """The action space that training sees, with a digest of its bounds."""
    max_episode_steps: int | None
    """The time limit of the environment itself, in steps."""

    @property
    def name(self) -> str:
        """The id, or the name of the class."""
        return self.id or self.cls.rpartition(":")[2]

    def as_json(self) -> dict[str, Any]:
        """Returns the description as JSON represents it."""
        return asdict(self)


def describe_entry(
    entry: EnvEntry, spec: EnvSpec, kwargs: Mapping[str, Any], env: gym.Env, max_episode_steps: int | None
) -> EnvironmentDescription:
    """Describes a new environment of an entry of the registry, in the wrappers of ``gymnasium.make`` only.

    Args:
        entry: The entry, whose class has the code of its library.
        spec: The spec of the environment.
        kwargs: The keyword arguments of the constructor.
        env: The environment, or one with its spaces and its table.
        max_episode_steps: The time limit of the environment.
    """
    return EnvironmentDescription(
        id=spec.id,
        cls=str(spec.entry_point),
        code=LIBRARY,
        kwargs=describe_values(without_rendering({**spec.kwargs, **kwargs})),
        wrappers=(),
        attributes={} if entry.has_table else constants_of(entry, env.unwrapped),
        table=None,
        observation_space=space_text(env.observation_space),
        action_space=space_text(env.action_space),
        max_episode_steps=max_episode_steps,
    )


def constants_of(entry: EnvEntry, unwrapped: gym.Env) -> dict[str, Any]:
    """Returns the described constants of an environment with equations, such as gravity."""
    return describe_values({name: getattr(unwrapped, name, None) for name in parameter_names(entry.name)})


def without_rendering(kwargs: Mapping[str, Any]) -> dict[str, Any]:
    """Returns keyword arguments of a constructor without those that change no number."""
    return {name: value for name, value in kwargs.items() if name not in UNIMPORTANT}


D = TypeVar("D", WrapperDescription, EnvironmentDescription)


def from_json(content: Any) -> EnvironmentDescription:
    """Returns the description that a file holds.

    Raises:
        TypeError: if it holds other fields.
        ValueError: if a field has the wrong type.
    """
    if not isinstance(content, dict) or not isinstance(content.get("wrappers"), list | tuple):
        raise ValueError("its environment has no wrappers")
    wrappers = tuple(_checked(WrapperDescription(**wrapper)) for wrapper in content["wrappers"])
    return _checked(EnvironmentDescription(**{**content, "wrappers": wrappers}))


def _checked(description: D) -> D:
    kinds: dict[str, Any] = {
        "id": (str, type(None)),
        "cls": str,
        "code": (str, type(None)),
        "kwargs": (dict, type(None)) if isinstance(description, WrapperDescription) else dict,
        "attributes": dict,
        "wrappers": tuple,
        "table": (str, type(None)),
        "observation_space": str,
        "action_space": str,
        "max_episode_steps": (int, type(None)),
    }
    for field in fields(description):
        value = getattr(description, field.name)
        if not isinstance(value, kinds[field.name]):
            raise ValueError(f"its environment has a bad {field.name}: {value!r:.100}")
    return description


_LOGGER = logging.getLogger("qtab")
_logged: set[str] = set()
"""The messages that were logged in this process."""
_NOT_SET = "as the constructor leaves it"


def differences(trained_on: EnvironmentDescription, given: EnvironmentDescription) -> list[str]:
    """Returns the differences, in sentences; none if the two are equal as far as is known.

    The id of this package and that of Gymnasium count as equal, since they have the same numbers. The time limit is a
    setting of the run, and is compared there. Edited code of the user may still give the same numbers, so that it
    is only logged, once per process. The sentences do not name a run, because estimates and tables have an environment
    too.

    Args:
        trained_on: The environment of a run, of estimates or of a table.
        given: The environment to compare with it.
    """
    for name in _edited(trained_on, given):
        _log_once(f"the code of {name} was edited: its numbers may differ from earlier ones")
    return list(_all(trained_on, given))


def _edited(ours: EnvironmentDescription, theirs: EnvironmentDescription) -> Iterator[str]:
    pairs: list[tuple[Any, Any]] = [(ours, theirs), *zip(ours.wrappers, theirs.wrappers, strict=False)]
    for one, other in pairs:
        if _class_name(one) == _class_name(other) and one.code != other.code and are_comparable(one.code, other.code):
            yield _class_name(one)


def _log_once(message: str) -> None:
    if message not in _logged:
        _logged.add(message)
        _LOGGER.warning("%s", message)


def _all(ours: EnvironmentDescription, theirs: EnvironmentDescription) -> Iterator[str]:
    if bare_id(ours.name) != bare_id(theirs.name):
        yield f"it was {ours.name}, and is now {theirs.name}"
        return
    if not (ours.code == theirs.code == LIBRARY):
        if _class_name(ours) != _class_name(theirs):
            yield f"its class was {ours.cls}, and is now {theirs.cls}"
        elif LIBRARY in (ours.code, theirs.code):
            yield f"methods of its class {_class_name(ours)} {_replaced(ours)}"
    yield from _values("its argument", ours.kwargs, theirs.kwargs, "not given")
    yield from _values("its attribute", ours.attributes, theirs.attributes, _NOT_SET)
    if ours.table != theirs.table:
        yield "its transition table has changed"
    yield from _wrappers(ours.wrappers, theirs.wrappers)
    for name in ("observation_space", "action_space"):
        one, other = getattr(ours, name), getattr(theirs, name)
        if one != other:
            yield f"its {name} was {without_digest(one)}, and is now {without_digest(other)}"


def _wrappers(ours: tuple[WrapperDescription, ...], theirs: tuple[WrapperDescription, ...]) -> Iterator[str]:
    if [wrapper.name for wrapper in ours] != [wrapper.name for wrapper in theirs]:
        yield f"it was {_listed(ours)}, and is now {_listed(theirs)}"
        return
    for one, other in zip(ours, theirs, strict=True):
        if one.code != other.code and LIBRARY in (one.code, other.code):
            yield f"methods of the wrapper {one.name} {_replaced(one)}"
        what = f"of the wrapper {one.name}, the"
        if one.kwargs is not None and other.kwargs is not None:
            yield from _values(f"{what} argument", one.kwargs, other.kwargs, "not given")
        yield from _values(f"{what} attribute", one.attributes, other.attributes, _NOT_SET)


def _listed(wrappers: tuple[WrapperDescription, ...]) -> str:
    return f"in the wrapper {', '.join(wrapper.name for wrapper in wrappers)}" if wrappers else "without a wrapper"


def _values(what: str, ours: Mapping[str, Any], theirs: Mapping[str, Any], missing: str) -> Iterator[str]:
    show: Callable[[Mapping[str, Any], str], str] = lambda held, name: in_words(held[name]) if name in held else missing  # noqa: E731
    for name in sorted(ours.keys() | theirs.keys()):
        if name in ours and name in theirs and same(ours[name], theirs[name]):
            continue
        yield f"{what} {name} was {show(ours, name)}, and is now {show(theirs, name)}"


def _replaced(ours: EnvironmentDescription | WrapperDescription) -> str:
    return "have been replaced since" if ours.code == LIBRARY else "were replaced then, and are not now"


def _class_name(description: EnvironmentDescription | WrapperDescription) -> str:
    return description.cls.rpartition(":")[2].rpartition(".")[2]

"""The description of an environment that a run was trained on."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, TypeVar


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

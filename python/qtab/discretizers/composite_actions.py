"""Actions of a Tuple or a Dict space, which are made of the actions of its parts."""

from collections.abc import Iterable, Sequence, Sized
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

Part = TypeVar("Part", bound=Sized)


@dataclass(frozen=True)
class Composite(Generic[Part]):
    """The parts of an action."""

    parts: tuple[Part, ...]
    """The actions of each part."""
    keys: tuple[str, ...] | None = None
    """The keys of a Dict space, in its order; None for a Tuple space."""

    def combine(self, values: Iterable[Any]) -> Any:
        """Returns one value for each part as a tuple or a dict."""
        return tuple(values) if self.keys is None else dict(zip(self.keys, values, strict=True))


def flat(action: Any) -> Sequence[Any]:
    """Returns the numbers of an action, whatever its structure, in order."""
    if isinstance(action, dict):
        return [number for part in action.values() for number in flat(part)]
    if isinstance(action, tuple):
        return [number for part in action for number in flat(part)]
    return action.ravel().tolist() if hasattr(action, "ravel") else [action]

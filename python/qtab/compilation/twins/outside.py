"""What the methods of an environment use outside of it."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Outside:
    """What the methods of an environment use outside of it."""

    shared: list[Any]
    """The lists, dicts, sets, deques and arrays that they read: of its class, of modules, of default arguments."""
    message: str | None
    """The file and the line of the first call of ``gymnasium.logger``, which compiled code leaves out; else None."""

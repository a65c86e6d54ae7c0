"""A recorded episode."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, repr=False)
class Recording:
    """One episode that can be replayed."""

    episode: int
    """The number of the episode in its run, from 0."""
    start: Mapping[str, Any]
    """The state of the environment's bit generator before the episode's reset."""
    actions: tuple[Any, ...]
    """What ``env.step`` was given: integers, with the start of a Discrete space added, or arrays."""

    def __repr__(self) -> str:
        return f"<Recording of episode {self.episode}: {len(self.actions):,} actions>"

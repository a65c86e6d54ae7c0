"""Recorded episodes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from qtab.config import Config


@dataclass(frozen=True, repr=False)
class Recording:
    """One episode that can be replayed."""

    episode: int
    """The number of the episode in its run, from 0."""
    start: Mapping[str, Any]
    """The state of the environment's bit generator before the episode's reset."""
    actions: tuple[Any, ...]
    """The arguments of ``env.step``: integers, with the start of a Discrete space added, or arrays."""

    def __repr__(self) -> str:
        return f"<Recording of episode {self.episode}: {len(self.actions):,} actions>"


def generator_states(config: Config, recorded: Sequence[Any]) -> list[dict[str, Any]]:
    """Returns the state of the environment's bit generator before each recorded episode.

    Args:
        config: The resolved config of the run.
        recorded: For each episode the number of 64-bit words drawn since seeding and the buffered uint32 (None if there
            is none); or the state itself; or any other value, for an episode that starts right after seeding.
    """
    return [_generator_state(config.seed, start) for start in recorded]


def _generator_state(seed: int | None, start: Any) -> dict[str, Any]:
    if isinstance(start, dict):
        return start
    generator = np.random.PCG64(seed)
    if isinstance(start, tuple):
        words_drawn, buffered_uint32 = start
        generator.advance(words_drawn)
        state: dict[str, Any] = dict(generator.state)
        return {**state, "has_uint32": int(buffered_uint32 is not None), "uinteger": buffered_uint32 or 0}
    return dict(generator.state)

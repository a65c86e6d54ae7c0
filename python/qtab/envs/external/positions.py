"""Positions of the generators of environments, the words drawn since the seed as Rust counts them, and failed calls."""

from collections.abc import Mapping
from typing import Any, NamedTuple, TypeAlias

import numpy as np

Position: TypeAlias = tuple[int, int | None]
"""The number of 64-bit words that a generator has drawn, and the half of the last word that was not used yet; None if
there is none."""


class FailedCall(NamedTuple):
    """A call of ``reset`` or ``step`` that failed, as Rust passes it to be repeated in Python."""

    state: bytes | None
    """The bytes of the state before the step; None for a reset."""
    before: Position
    """The position of the generator before the call."""
    action: int | None
    """The action, counted from 0; None for a reset."""
    seed: int
    """The seed of the run."""
    played: tuple[Position, list[int]] | None
    """The position before the reset of the episode, and the actions since then; None if they are not kept or not known,
    as in a run that was resumed within an episode."""


_MULTIPLIER, _MASK = 0x2360_ED05_1FC6_5DA4_4385_DF64_9FCC_F645, (1 << 128) - 1


def generator_at(seed: int, position: Position) -> np.random.Generator:
    """Returns the generator of ``env.reset(seed=seed)`` at a position."""
    words_drawn, buffered_uint32 = position
    bit_generator = np.random.PCG64(seed)
    bit_generator.advance(words_drawn)
    if buffered_uint32 is not None:
        bit_generator.state = {**bit_generator.state, "has_uint32": 1, "uinteger": buffered_uint32}
    return np.random.Generator(bit_generator)


def position_of(rng: np.random.Generator, seed: int) -> Position:
    """Returns the position of a generator that was seeded with ``seed``."""
    state: Any = rng.bit_generator.state
    buffered = int(state["uinteger"]) if state["has_uint32"] else None
    first: Any = np.random.PCG64(seed).state
    return _words_between(first["state"], state["state"]), buffered


def _words_between(first: Mapping[str, int], last: Mapping[str, int]) -> int:
    """Returns how often a PCG64 steps from one state to another, bit by bit (Brown, 1994)."""
    state, multiplier, increment = first["state"], _MULTIPLIER, first["inc"]
    words, bit = 0, 1
    while state != last["state"]:
        if (state ^ last["state"]) & bit:
            state = (state * multiplier + increment) & _MASK
            words |= bit
        bit <<= 1
        increment = (multiplier + 1) * increment & _MASK
        multiplier = multiplier * multiplier & _MASK
    return words

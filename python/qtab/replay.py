"""Playing recorded episodes again, in Gymnasium's own environment: the same starts, the same actions."""

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.run import Recording


def starts(config: Config, recorded: Sequence[Any]) -> list[dict[str, Any]]:
    """Returns the bit generator's state before each recorded episode.

    A recorded start is the number of words drawn since seeding and the buffered half, or the state itself, or the seed
    of the first reset.
    """
    return [_generator_state(config.seed, start) for start in recorded]


def _generator_state(seed: int | None, start: Any) -> dict[str, Any]:
    if isinstance(start, dict):
        return start
    generator = np.random.PCG64(seed)
    if isinstance(start, tuple):
        drawn, half = start
        generator.advance(drawn)
        state: dict[str, Any] = dict(generator.state)
        return {**state, "has_uint32": int(half is not None), "uinteger": half or 0}
    return dict(generator.state)


def play(env: gym.Env, recording: Recording) -> float:
    """Plays a recorded episode in ``env`` and returns its return.

    The environment draws from its ``np_random`` alone, as every environment of Gymnasium's does.
    """
    bit_generator = np.random.PCG64()
    bit_generator.state = dict(recording.start)  # type: ignore[assignment]
    env.unwrapped.np_random = np.random.Generator(bit_generator)
    env.reset()
    total = 0.0
    for action in recording.actions:
        _, reward, _, _, _ = env.step(action)
        total += float(reward)
    return total

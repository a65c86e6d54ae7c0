"""Playing recorded episodes again, in Gymnasium's own environment: the same starts, the same actions."""

from collections.abc import Sequence
from contextlib import closing
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils.progress import ProgressBar
from qtab.config import Config
from qtab.results.run import Recording, Run


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


def make_render_env(config: Config, render_mode: str) -> gym.Env:
    """Makes the environment of a run once more, to be looked at.

    Raises:
        ValueError: if it cannot be rendered so.
    """
    kwargs = {**config.env_kwargs, "render_mode": render_mode}
    with closing(gym.make(config.env, **config.env_kwargs)) as env:
        modes = env.metadata.get("render_modes", [])
    if render_mode not in modes:
        raise ValueError(f"{config.env} cannot be rendered as {render_mode!r}; it has {', '.join(modes) or 'no mode'}")
    return gym.make(config.env, max_episode_steps=config.max_episode_steps, **kwargs)


def replay_episode(env: gym.Env, recording: Recording) -> float:
    """Plays a recorded episode in ``env`` and returns its return.

    The environment draws from its ``np_random`` alone, as every environment of Gymnasium's does.
    """
    bit_generator = np.random.PCG64()
    bit_generator.state = dict(recording.start)  # type: ignore[assignment]
    env.unwrapped.np_random = np.random.Generator(bit_generator)
    env.reset()
    total = 0.0
    for action in recording.actions:
        _, reward, terminated, truncated, _ = env.step(action)
        total += float(reward)
        if terminated or truncated:
            break
    return total


def replay_all(env: gym.Env, run: Run, progress: bool | None = None) -> int:
    """Plays all recorded episodes of a run in ``env``, and returns how many had another return than in training.

    An environment that carries more from episode to episode than its ``np_random`` can differ.
    """
    different = 0
    with ProgressBar(len(run.recordings), "episode", progress, "replay") as shown:
        for index, recording in enumerate(run.recordings):
            different += replay_episode(env, recording) != run.episode_returns[recording.episode]
            shown.move_to(index + 1)
    return different

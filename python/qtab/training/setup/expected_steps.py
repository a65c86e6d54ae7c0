"""The expected number of steps of a run, before an ordinary class is compiled for it."""

import warnings
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.envs.in_rust.matching import time_limit
from qtab.training.setup.use import TYPICAL_MAX_STEPS

if TYPE_CHECKING:
    from qtab.compilation.ordinary import OrdinaryEnv

PLAYED = 1_000
"""The steps that are played to see how long episodes are."""


def most_steps(env: gym.Env, config: Config) -> int:
    """Returns the most steps that count for a run: episodes times their time limit, or ``TYPICAL_MAX_STEPS``."""
    return config.episodes * _limit(env, config)


def expected_steps(env: gym.Env, config: Config, one: "OrdinaryEnv") -> int:
    """Returns the steps of a run if its episodes are as long as those of random actions, with seed 0.

    Args:
        env: The environment, perhaps in wrappers. It is not changed.
        config: The settings given.
        one: The class, which has no effects elsewhere.
    """
    limit, finished, elapsed = _limit(env, config), 0, 0
    choose, twin = np.random.default_rng(0), one.copy()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            info = twin.reset(seed=0)[1]
            for _ in range(PLAYED):
                _, _, terminated, truncated, info = twin.step(_action(twin, info, choose))
                elapsed += 1
                if terminated or truncated or elapsed >= limit:
                    finished, elapsed = finished + 1, 0
                    info = twin.reset()[1]
        except Exception:  # it is raised again when the first episodes are compared
            return config.episodes * limit
    return config.episodes * min(limit, PLAYED // max(finished, 1))


def _limit(env: gym.Env, config: Config) -> int:
    limits = [one for one in (config.max_episode_steps, time_limit(env)) if one is not None]
    return min([*limits, TYPICAL_MAX_STEPS])


def _action(env: Any, info: Any, choose: np.random.Generator) -> int:
    space, start = env.action_space, int(env.action_space.start)
    mask = env.action_masks() if hasattr(env, "action_masks") else info.get("action_mask")
    if mask is None:
        return start + int(choose.integers(0, int(space.n)))
    return start + int(choose.choice(np.flatnonzero(mask)))

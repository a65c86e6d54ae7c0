"""What returns mean in an environment: the threshold at which it is solved, and the best return that is known."""

from contextlib import suppress

import gymnasium as gym

from qtab.config import Config
from qtab.envs.registry import gymnasium_id, spec_of

BEST_KNOWN_MOUNTAIN_CAR = -97.668
"""The expected return that ``qtab.optimum("MountainCar-v0")`` finds in seconds."""
MAX_QUICK_UPDATES = 10**8
"""The optimum of a table is computed if it needs at most this many updates, which take less than a second."""


def reward_threshold(env: str) -> float | None:
    """Returns the return at which Gymnasium considers an environment solved; None where it gives none."""
    with suppress(gym.error.Error):  # the class of an environment that has no id
        return spec_of(env).reward_threshold
    return None


def is_usual_mountain_car(config: Config) -> bool:
    """Returns whether a run is on MountainCar-v0 with its own constants and time limit."""
    usual = not config.env_kwargs.get("goal_velocity") and config.max_episode_steps == 200
    return usual and gymnasium_id(config.env) == "MountainCar-v0"

"""The environment of a run, made again to be stepped in Python."""

import gymnasium as gym

from qtab.config import Config
from qtab.envs.registry import ENTRIES, gymnasium_id
from qtab.envs.stored import spec_of_run


def make_run_env(config: Config) -> gym.Env:
    """Makes the environment of a run, with its keyword arguments and its time limit.

    Of the environments of Gymnasium that this package has, it is this package's class, which is equal and faster. An id
    from a file must be registered: nothing is imported for it.

    Raises:
        gymnasium.error.UnregisteredEnv: if the run was trained on an environment that is not registered.
    """
    name = gymnasium_id(config.env)
    return gym.make(
        f"qtab/{name}" if name in ENTRIES else spec_of_run(config.env),
        max_episode_steps=config.max_episode_steps,
        disable_env_checker=True,
        **config.env_kwargs,
    )

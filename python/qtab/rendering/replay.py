"""Replay of recorded episodes in Gymnasium's environment, from the same initial states and with the same actions."""

from collections.abc import Callable, Mapping
from contextlib import closing
from typing import Any

import gymnasium as gym

from qtab._utils.progress import ProgressBar
from qtab.config import Config
from qtab.results.run import Recording, Run
from qtab.results.run_state import restored_generator
from qtab.training.restore import continue_after
from qtab.training.setup.run_env import make_run_env


def make_render_env(
    config: Config,
    render_mode: str,
    env_kwargs: Mapping[str, Any] | None = None,
    max_episode_steps: int | None = None,
) -> gym.Env:
    """Creates the environment of a run with a render mode.

    Args:
        config: The config of the run.
        render_mode: The render mode.
        env_kwargs: The keyword arguments of the environment's constructor; None takes the run's.
        max_episode_steps: Another time limit; None takes the run's.

    Raises:
        ValueError: if the environment does not have this render mode, or cannot be made as it was in training.
    """
    with closing(make_run_env(config, of="id", env_kwargs=env_kwargs)) as env:
        check_render_mode(config.env, env, render_mode)
    return make_run_env(
        config, of="id", env_kwargs=env_kwargs, max_episode_steps=max_episode_steps, render_mode=render_mode
    )


def check_render_mode(name: str, env: gym.Env, render_mode: str) -> None:
    """Checks that an environment has a render mode.

    Raises:
        ValueError: if it does not.
    """
    modes = env.metadata.get("render_modes", [])
    if render_mode not in modes:
        known = ", ".join(map(repr, modes)) or "none"
        raise ValueError(f"{name} cannot be rendered as {render_mode!r}; its render modes are: {known}")


def replay_episode(env: gym.Env, recording: Recording, on_frame: Callable[[], object] = lambda: None) -> float:
    """Replays a recorded episode in ``env`` and returns its return.

    It calls ``on_frame`` after the reset and after each step.

    The episode is the same if the environment draws random numbers from its ``np_random`` only, as all environments of
    Gymnasium do.
    """
    env.unwrapped.np_random = restored_generator(recording.start)
    env.reset()
    on_frame()
    episode_return = 0.0
    for action in recording.actions:
        _, reward, terminated, truncated, _ = env.step(action)
        episode_return += float(reward)
        on_frame()
        if terminated or truncated:
            break
    return episode_return


def replay_all(
    env: gym.Env,
    run: Run,
    progress: bool | None = None,
    replay: Callable[[gym.Env, Recording], float] = replay_episode,
) -> int:
    """Replays all recorded episodes of a run in ``env``, and returns the number with another return than in training.

    The environment is seeded first, as for the run. If it has a method ``resume_after``, this is called before each
    episode with the number of steps that the run had taken. A return can differ if the environment keeps state between
    episodes other than its ``np_random``.
    """
    different = 0
    if run.recordings:
        # The first reset of a run can draw state for all episodes, such as a bandit problem, which is needed again.
        env.unwrapped.reset(seed=run.config.seed)
    with ProgressBar(len(run.recordings), "episode", progress, "replay") as bar:
        for index, recording in enumerate(run.recordings):
            continue_after(env, int(run.episode_lengths[: recording.episode].sum()))
            different += replay(env, recording) != run.episode_returns[recording.episode]
            bar.move_to(index + 1)
    return different

"""Gymnasium's wrappers and checker work on our environments, and return the same as on Gymnasium's."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import wrappers
from gymnasium.utils.env_checker import check_env

from support.exact import bitwise, identical
from support.lockstep.classic_control import IDS as CLASSIC
from support.lockstep.toy_text import IDS as TOYS

IDS = [*CLASSIC, *TOYS]
REGISTERED = sorted(name for name in gym.registry if name.startswith("qtab/"))
STEPS = 60


def comparable(value: Any) -> Any:
    """Types and bytes of whatever a wrapper returns, except the seconds that an episode took."""
    if isinstance(value, (tuple, list)):
        return type(value), [comparable(item) for item in value]
    if isinstance(value, dict):
        return [(key, comparable(item)) for key, item in value.items() if key != "t"]
    return bitwise(value)


def made(name: str, wrap: Callable[[gym.Env], gym.Env], **kwargs: Any) -> Any:
    """A wrapped environment, or the error that Gymnasium raises."""
    env = gym.make(name, **kwargs)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return wrap(env)
        except Exception as error:
            return type(error), str(error)


def walk(env: gym.Env, steps: int = STEPS) -> list[Any]:
    """Everything that a random walk over several episodes returns."""
    env.action_space.seed(5)
    seen: list[Any] = [comparable(env.reset(seed=3))]
    for _ in range(steps):
        answer = env.step(env.action_space.sample())
        seen.append(comparable(answer))
        if answer[2] or answer[3]:
            seen.append(comparable(env.reset()))
    return seen


WRAPPERS: dict[str, Callable[[gym.Env], gym.Env]] = {
    "Autoreset": wrappers.Autoreset,
    "ClipReward": lambda env: wrappers.ClipReward(env, -0.5, 0.5),
    "DelayObservation": lambda env: wrappers.DelayObservation(env, 2),
    "DiscretizeAction": lambda env: wrappers.DiscretizeAction(env, bins=5),
    "DiscretizeObservation": lambda env: wrappers.DiscretizeObservation(env, bins=7),
    "DtypeObservation": lambda env: wrappers.DtypeObservation(env, np.float16),
    "FlattenObservation": wrappers.FlattenObservation,
    "FrameStackObservation": lambda env: wrappers.FrameStackObservation(env, 3),
    "MaxAndSkipObservation": lambda env: wrappers.MaxAndSkipObservation(env, skip=2),
    "NormalizeObservation": wrappers.NormalizeObservation,
    "NormalizeReward": wrappers.NormalizeReward,
    "RecordEpisodeStatistics": wrappers.RecordEpisodeStatistics,
    "RepeatAction": lambda env: wrappers.RepeatAction(env, num_repeats=3),
    "RescaleAction": lambda env: wrappers.RescaleAction(env, np.float32(-1), np.float32(1)),
    "RescaleObservation": lambda env: wrappers.RescaleObservation(env, np.float32(-1), np.float32(1)),
    "StickyAction": lambda env: wrappers.StickyAction(env, 0.3),
    "TimeAwareObservation": wrappers.TimeAwareObservation,
    "TimeLimit": lambda env: wrappers.TimeLimit(env, 17),
    "TransformReward": lambda env: wrappers.TransformReward(env, lambda reward: 3 * float(reward) + 1),
}
FIT_ALL = {
    "Autoreset",
    "ClipReward",
    "RecordEpisodeStatistics",
    "StickyAction",
    "TimeLimit",
    "TransformReward",
}
"""The wrappers that work with any spaces."""


@pytest.mark.parametrize("wrapper", WRAPPERS)
def test_a_wrapper_returns_the_same_around_ours(wrapper: str) -> None:
    fitting = set()
    for name in IDS:
        ours, theirs = made(f"qtab/{name}", WRAPPERS[wrapper]), made(name, WRAPPERS[wrapper])
        if not isinstance(theirs, gym.Env):
            assert ours == theirs
            continue
        fitting.add(name)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Gymnasium's wrappers warn
            assert (ours.observation_space, ours.action_space) == (theirs.observation_space, theirs.action_space)
            assert walk(ours) == walk(theirs), name
    assert fitting == set(IDS) if wrapper in FIT_ALL else fitting


def test_statistics_of_episodes_are_gymnasiums() -> None:
    ours, theirs = (wrappers.RecordEpisodeStatistics(gym.make(name)) for name in ("qtab/CartPole-v1", "CartPole-v1"))
    assert walk(ours, 150) == walk(theirs, 150)
    assert list(ours.return_queue) == list(theirs.return_queue)
    assert list(ours.length_queue) == list(theirs.length_queue)
    assert len(ours.return_queue) > 3


@pytest.mark.parametrize("name", ["MountainCar-v0", "CartPole-v1", "FrozenLake-v1", "Blackjack-v1"])
def test_a_recorded_video_holds_gymnasiums_frames(name: str, tmp_path: Path) -> None:
    theirs = gym.make(name, render_mode="rgb_array", max_episode_steps=20)
    ours = wrappers.RecordVideo(
        gym.make(f"qtab/{name}", render_mode="rgb_array", max_episode_steps=20),
        str(tmp_path / "videos"),
        episode_trigger=lambda episode: episode == 0,
        disable_logger=True,
    )
    ours.action_space.seed(5)
    ours.reset(seed=3)
    theirs.reset(seed=3)
    over = False
    recorded: list[Any] = list(ours.recorded_frames)
    frames = [theirs.render()]
    while not over:
        action = ours.action_space.sample()
        *_, terminated, truncated, _ = ours.step(action)
        recorded = list(ours.recorded_frames) or recorded
        over = terminated or truncated
        theirs.step(action)
        frames.append(theirs.render())
    ours.close()
    assert next((tmp_path / "videos").glob("*.mp4")).stat().st_size > 0
    assert len(recorded) == len(frames) > 1
    assert identical(recorded, frames)


@pytest.mark.parametrize("name", REGISTERED)
def test_every_environment_passes_gymnasiums_checker(name: str) -> None:
    smaller: dict[str, Any] = {"cars": 4} if "JacksCarRental" in name else {}  # of 20, it takes a second
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # CartPole-v0 is out of date
        env = gym.make(name, **smaller)
    with warnings.catch_warnings():
        # The checker recommends other bounds than Gymnasium's own environments have.
        warnings.filterwarnings("ignore", message=".*(action|observation) space|.*maximum value|.*minimum value")
        check_env(env.unwrapped, skip_render_check=True)


def test_every_known_environment_is_registered() -> None:
    assert set(REGISTERED) >= {f"qtab/{name}" for name in [*IDS, "CartPole-v0"]}

"""Gymnasium's wrappers, and rendering, on vector environments."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence

from support.lockstep import classic_control
from support.lockstep.vector import LockstepVectorEnv, ours, theirs

pytestmark = pytest.mark.filterwarnings("ignore:.*CartPole-v0 is out of date")


TEXTS = ["FrozenLake-v1", "CliffWalking-v1", "Taxi-v4"]
FRAMES = [
    (name, mode) for name in [*classic_control.IDS, *TEXTS, "Blackjack-v1"] for mode in ("rgb_array", "rgb_array_list")
]


@pytest.mark.parametrize(("name", "mode"), [*FRAMES, *((name, "ansi") for name in TEXTS)])
def test_frames_equal_gymnasiums(name, mode):
    vectors = LockstepVectorEnv(name, 2, render_mode=mode, max_episode_steps=4)
    assert vectors.ours.render_mode == mode
    assert vectors.ours.is_native == (mode != "rgb_array_list" and name != "Taxi-v4")
    if mode != "rgb_array_list":
        with pytest.raises(gym.error.ResetNeeded):
            vectors.ours.render()
    vectors.reset(seed=1)
    for _ in range(6):
        frames, expected = vectors.ours.render(), vectors.theirs.render()
        assert isinstance(frames, tuple)
        assert data_equivalence(frames, expected, exact=True)
        vectors.run(1)
    vectors.ours.close()


@pytest.mark.filterwarnings("ignore:.*human.*")
def test_human_mode_renders_like_gymnasium():
    vectors = LockstepVectorEnv("FrozenLake-v1", 1, render_mode="human")
    assert not vectors.ours.is_native
    vectors.reset(seed=0)
    vectors.run(2)
    frames: list[Any] = [vectors.ours.render(), vectors.theirs.render()]
    assert frames == [(None,), (None,)]
    vectors.ours.close()
    vectors.theirs.close()


def wrapped(env: Any) -> list[Any]:
    wrappers = gym.wrappers.vector
    return [
        wrappers.RecordEpisodeStatistics(env),
        wrappers.NormalizeObservation(env),
        wrappers.NormalizeReward(env),
        wrappers.ClipReward(env, -0.5, 0.5),
        wrappers.DictInfoToList(env),
        wrappers.FlattenObservation(env),
        wrappers.DtypeObservation(env, np.float64),
    ]


@pytest.mark.parametrize("index", range(7))
def test_gymnasiums_vector_wrappers_work(index):
    one, other = (
        wrapped(make("CartPole-v1", 4, max_episode_steps=20))[index]
        for make in (ours, lambda *args, **kwargs: theirs(args[0], args[1], **kwargs))
    )
    rng = np.random.default_rng(0)
    mine, gymnasiums = one.reset(seed=0), other.reset(seed=0)
    assert data_equivalence(mine, gymnasiums, exact=True)
    for _ in range(60):
        actions = rng.integers(0, 2, 4)
        mine, gymnasiums = one.step(actions), other.step(actions)
        for step in (mine, gymnasiums):
            if isinstance(step[4], dict) and "episode" in step[4]:
                step[4]["episode"].pop("t")  # seconds
        assert data_equivalence(mine, gymnasiums, exact=True)


def test_videos_are_recorded(tmp_path):
    env = gym.wrappers.vector.RecordVideo(
        ours("MountainCar-v0", 2, render_mode="rgb_array", max_episode_steps=5),
        str(tmp_path / "videos"),
        episode_trigger=lambda episode: episode == 0,
        disable_logger=True,
    )
    env.reset(seed=0)
    for _ in range(8):
        env.step(np.zeros(2, np.int64))
    env.close()
    assert [path.suffix for path in (tmp_path / "videos").iterdir()] == [".mp4"]

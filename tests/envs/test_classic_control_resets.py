"""A reset of classic control is Gymnasium's, whatever it draws from and whatever it is told."""

import copy
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from support.classic_control import CONTINUOUS, IDS, LockstepClassicControl
from support.exact import bitwise

ATTRIBUTES = ["state", "steps_beyond_terminated", "last_u"]


def same(pair: LockstepClassicControl) -> None:
    """The attributes that a reset leaves, and the generators."""
    for name in ATTRIBUTES:
        assert hasattr(pair.ours, name) == hasattr(pair.theirs, name), name
        if hasattr(pair.ours, name):
            assert bitwise(getattr(pair.ours, name)) == bitwise(getattr(pair.theirs, name)), name
    one, other = (env.np_random for env in (pair.ours, pair.theirs))
    if isinstance(one, np.random.Generator):
        assert frozen_generator(one) == frozen_generator(other)


def frozen_generator(generator: np.random.Generator) -> str:
    return repr(generator.bit_generator.state)


@pytest.mark.parametrize("name", IDS)
def test_every_first_state_is_gymnasiums(name: str) -> None:
    pair = LockstepClassicControl(name)
    for seed in [*range(1000), *[None] * 1000, 2**64, 0]:
        pair.reset(seed=seed)
        same(pair)


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("bits", [np.random.MT19937, np.random.Philox, np.random.SFC64])
def test_the_users_generator_is_drawn_from(name: str, bits: Any) -> None:
    pair = LockstepClassicControl(name)
    for env in (pair.ours, pair.theirs):
        env.np_random = np.random.Generator(bits(5))
    for _ in range(20):
        pair.reset()
        same(pair)


@pytest.mark.parametrize("name", IDS)
def test_a_generator_that_is_not_numpys_is_asked_as_gymnasium_asks_it(name: str) -> None:
    class Mine(np.random.Generator):
        def uniform(self, low: Any = 0.0, high: Any = 1.0, size: Any = None) -> Any:
            return super().uniform(low, high, size) / 2

    pair = LockstepClassicControl(name)
    for generator in (Mine(np.random.PCG64(5)), np.random.RandomState(5)):
        pair.set(np_random=copy.deepcopy(generator))
        for _ in range(5):
            pair.reset()
            same(pair)


BOUNDS: list[Any] = [
    {},
    {"low": -0.2, "high": 0.1},
    {"low": "0.01", "high": np.float32(0.02)},
    {"low": 0.3, "high": -0.3},
    {"low": "left"},
    {"high": None},
    {"x_init": 0.1, "y_init": "2"},
    {"x_init": -1},
    {"y_init": [1]},
    {"unknown": 1},
    7,
]


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("options", BOUNDS, ids=repr)
def test_options_are_gymnasiums_to_read(name: str, options: Any) -> None:
    pair = LockstepClassicControl(name)
    for seed in (3, None, None):
        pair.reset(seed=seed, options=options)
    same(pair)


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("seed", ["x", -1, 1.5, np.int64(3)], ids=repr)
def test_an_odd_seed_is_gymnasiums_to_judge(name: str, seed: Any) -> None:
    LockstepClassicControl(name).reset(seed=seed)


@pytest.mark.parametrize("name", IDS)
def test_a_reset_forgets_the_episode_before(name: str) -> None:
    pair = LockstepClassicControl(name)
    action = np.array([0.5], np.float32) if name in CONTINUOUS else 1
    for _ in range(3):
        pair.reset(seed=4)
        for _ in range(30):
            pair.both(lambda env: env.step(action))
        pair.assert_same_state()
    pair.reset()
    same(pair)


@pytest.mark.parametrize("name", IDS)
def test_a_person_watches_the_first_state(name: str) -> None:
    counts = []
    for env_id in (f"qtab/{name}", name):
        env: Any = gym.make(env_id, render_mode="human")
        frames: list[Any] = []

        def render(frames: list[Any] = frames, env: Any = env.unwrapped) -> None:
            frames.append(bitwise(env.state))

        env.unwrapped.render = render
        env.reset(seed=0)
        env.reset()
        counts.append(frames)
        env.close()
    assert counts[0] == counts[1]
    assert len(counts[0]) == 2


@pytest.mark.parametrize("name", IDS)
def test_a_reset_of_ones_own_may_call_ours(name: str) -> None:
    base: Any = type(gym.make(f"qtab/{name}").unwrapped)

    class Mine(base):  # type: ignore[misc]
        def reset(self, *, seed: Any = None, options: Any = None) -> Any:
            observation, _ = super().reset(seed=seed, options=options)
            return observation, {"mine": True}

    observation, info = Mine().reset(seed=6)
    expected, _ = gym.make(name).unwrapped.reset(seed=6)
    assert info == {"mine": True}
    assert bitwise(observation) == bitwise(expected)

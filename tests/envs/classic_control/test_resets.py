"""Resets of classic control equal Gymnasium's, for any generator and any options."""

import copy
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from support.exact import bitwise
from support.lockstep.classic_control import CONTINUOUS, IDS, LockstepClassicControl

ATTRIBUTES = ["state", "steps_beyond_terminated", "last_u"]


def same(pair: LockstepClassicControl) -> None:
    """Asserts that the attributes after a reset and the generators are the same."""
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
def test_every_first_state_equals_gymnasiums(name: str) -> None:
    pair = LockstepClassicControl(name)
    for seed in [*range(1000), *[None] * 1000, 2**64, 0]:
        pair.reset(seed=seed)
        same(pair)


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("bits", [np.random.MT19937, np.random.Philox, np.random.SFC64])
def test_an_assigned_generator_is_used(name: str, bits: Any) -> None:
    pair = LockstepClassicControl(name)
    for env in (pair.ours, pair.theirs):
        env.np_random = np.random.Generator(bits(5))
    for _ in range(20):
        pair.reset()
        same(pair)


@pytest.mark.parametrize("name", IDS)
def test_any_object_with_a_generators_methods_is_used_as_in_gymnasium(name: str) -> None:
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
def test_reset_options_have_gymnasiums_result(name: str, options: Any) -> None:
    pair = LockstepClassicControl(name)
    for seed in (3, None, None):
        pair.reset(seed=seed, options=options)
    same(pair)


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("seed", ["x", -1, 1.5, np.int64(3)], ids=repr)
def test_an_odd_seed_has_gymnasiums_result(name: str, seed: Any) -> None:
    LockstepClassicControl(name).reset(seed=seed)


@pytest.mark.parametrize("name", IDS)
def test_a_reset_clears_the_previous_episode(name: str) -> None:
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
def test_the_first_state_is_rendered_in_human_mode(name: str) -> None:
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
def test_an_overridden_reset_may_call_ours(name: str) -> None:
    base: Any = type(gym.make(f"qtab/{name}").unwrapped)

    class Mine(base):  # type: ignore[misc]
        def reset(self, *, seed: Any = None, options: Any = None) -> Any:
            observation, _ = super().reset(seed=seed, options=options)
            return observation, {"mine": True}

    observation, info = Mine().reset(seed=6)
    expected, _ = gym.make(name).unwrapped.reset(seed=6)
    assert info == {"mine": True}
    assert bitwise(observation) == bitwise(expected)

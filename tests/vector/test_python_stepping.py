"""Accessing the sub-environments gives them in their current state, and switches to Python stepping."""

import subprocess
import sys
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode

from support.lockstep.vector import IDS, MODES, LockstepVectorEnv, ours, theirs

pytestmark = pytest.mark.filterwarnings("ignore:.*CartPole-v0 is out of date")


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", IDS)
def test_sub_environments_continue_from_their_current_state(name, mode):
    vectors = LockstepVectorEnv(name, 5, mode, max_episode_steps=6)
    vectors.reset(seed=2)
    vectors.run(8)
    kept = ["state", "s", "lastaction", "last_u", "fickle_step", "steps_beyond_terminated", "player", "dealer"]
    kept += ["dealer_top_card_suit", "dealer_top_card_value_str", "_elapsed_steps", "spec"]
    assert vectors.ours.is_native
    for attribute in (attribute for attribute in kept if hasattr(vectors.theirs.envs[0].unwrapped, attribute)):
        mine: Any = vectors.ours.get_attr(attribute)
        gymnasiums: Any = vectors.theirs.get_attr(attribute)
        if attribute == "state":  # at the left wall Gymnasium's MountainCar has a velocity of integer 0
            assert list(map(type, mine)) == list(map(type, gymnasiums))
            mine, gymnasiums = (tuple(np.asarray(state) for state in states) for states in (mine, gymnasiums))
        if attribute == "s":  # sometimes an integer of Python, sometimes of NumPy
            mine, gymnasiums = (list(map(int, states)) for states in (mine, gymnasiums))
        if attribute != "spec":
            assert data_equivalence(mine, gymnasiums, exact=True), attribute
    assert not vectors.ours.is_native
    vectors.run(20)
    vectors.same_streams()
    if vectors.ours.metadata["autoreset_mode"] is not AutoresetMode.DISABLED:
        mask = np.array([True, False, False, True, False])
        vectors.reset(seed=4, options={"reset_mask": mask})
        vectors.run(9)


def test_assigned_attributes_are_used():
    vectors = LockstepVectorEnv("MountainCar-v0", 3)
    vectors.reset(seed=0)
    for env in (vectors.ours, vectors.theirs):
        env.set_attr("gravity", 0.001)
        env.set_attr("force", [0.001, 0.002, 0.003])
        assert env.get_attr("force") == (0.001, 0.002, 0.003)
        with pytest.raises(ValueError, match="length equal to the number of environments"):
            env.set_attr("force", [0.1])
    vectors.run(30)
    vectors = LockstepVectorEnv("CartPole-v1", 2)
    for env in (vectors.ours, vectors.theirs):  # also before the first reset
        env.set_attr("gravity", 20.0)
    vectors.reset(seed=0)
    vectors.run(30)
    assert [type(env.unwrapped).__module__ for env in vectors.ours.envs] == ["qtab.envs.classic_control"] * 2
    taxis = LockstepVectorEnv("Taxi-v4", 2)
    taxis.reset(seed=3)
    mine, gymnasiums = (env.call("action_mask", 7) for env in (taxis.ours, taxis.theirs))
    assert data_equivalence(mine, gymnasiums, exact=True)


def test_sub_environments_accessed_before_the_first_reset_are_reset_like_others():
    vectors = LockstepVectorEnv("CartPole-v1", 3, AutoresetMode.SAME_STEP)
    for env in (vectors.ours, vectors.theirs):
        env.set_attr("force_mag", 5.0)
    with pytest.raises(gym.error.ResetNeeded, match="leave out sub-environment 2"):
        vectors.ours.reset(options={"reset_mask": np.array([True, True, False])})
    vectors.reset(seed=1)
    vectors.reset(options={"reset_mask": np.array([True, True, False])})
    vectors.run(40)


@pytest.mark.filterwarnings("ignore:.*:UserWarning")
def test_a_table_that_rust_refuses_is_stepped_in_python():
    for name, kwargs in (
        ("FrozenLake-v1", {"reward_schedule": (float("inf"), 0, 0)}),
        ("Taxi-v4", {"is_rainy": True, "rainy_probability": 1.5}),
    ):
        vectors = LockstepVectorEnv(name, 2, **kwargs)
        assert not vectors.ours.is_native
        vectors.reset(seed=0)
        vectors.run(30)


def test_a_constant_that_rust_does_not_know_is_stepped_in_python():
    unknown: dict[str, Any] = {
        "MountainCar-v0": {"goal_velocity": np.float32(0.01)},
        "Pendulum-v1": {"g": np.float32(9)},
    }
    for name, kwargs in unknown.items():
        vectors = LockstepVectorEnv(name, 3, **kwargs)
        assert not vectors.ours.is_native
        vectors.reset(seed=1)
        vectors.run(20)
        assert vectors.ours.np_random_seed == (1, 2, 3)
    with pytest.raises(TypeError, match="gravity"):
        ours("Pendulum-v1", 2, gravity=3.0)
    with pytest.raises(TypeError, match="copy"):
        theirs("Pendulum-v1", 2, copy=3.0)


@pytest.mark.parametrize(
    ("options", "name"), [({"low": -3e7, "high": 3e7}, "MountainCar-v0"), ({"high": 9e6}, "CartPole-v1")]
)
@pytest.mark.filterwarnings("ignore:.*:UserWarning")
def test_extreme_states_have_gymnasiums_result(options, name):
    vectors = LockstepVectorEnv(name, 2)
    vectors.reset(seed=0, options=options)
    assert not vectors.ours.is_native
    vectors.run(10)


def test_sub_environments_step_in_python_where_numpy_does_not_use_libm():
    done = subprocess.run([sys.executable, "-c", PATCHED], check=True, capture_output=True, text=True)
    assert done.stdout.split() == ["True", "False", "equal"]


PATCHED = """
import warnings, numpy as np
true = np.sin
np.sin = lambda x, *rest: np.nextafter(true(x, *rest), 2.0) if np.ndim(x) else np.nextafter(true(x), x.dtype.type(2.0))
import gymnasium as gym, qtab
warnings.simplefilter("ignore")
ours = qtab.RustVectorEnv("CartPole-v1", num_envs=3)
theirs = gym.vector.SyncVectorEnv([lambda: gym.make("CartPole-v1")] * 3)
ours.reset(seed=0), theirs.reset(seed=0)
for _ in range(30):
    one, other = ours.step(np.ones(3, int)), theirs.step(np.ones(3, int))
    assert all(mine.tobytes() == gymnasiums.tobytes() for mine, gymnasiums in zip(one[:4], other[:4]))
one, other = gym.make_vec("qtab/CartPole-v1", num_envs=3), gym.make_vec("CartPole-v1", num_envs=3)
one.reset(seed=0), other.reset(seed=0)
for _ in range(30):
    steps = one.step(np.ones(3, int)), other.step(np.ones(3, int))
    assert all(mine.tobytes() == gymnasiums.tobytes() for mine, gymnasiums in zip(steps[0][:4], steps[1][:4]))
print(gym.make_vec("qtab/MountainCar-v0", num_envs=3).is_native, ours.is_native, "equal")
"""

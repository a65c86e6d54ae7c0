"""Each vector environment equals a SyncVectorEnv of Gymnasium's environments, to the bit, in every autoreset mode."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from support.lockstep import classic_control
from support.lockstep.vector import IDS, MODES, LockstepVectorEnv
from support.processes.machine import MACHINE

STEPS = 220
"""Steps of all sub-environments together, in each of four examples of each of three modes."""
MAX_VECTOR_STEPS = 210
"""Steps of the vector environment in an example: more than the usual time limits, 100 and 200."""

SETTINGS: dict[str, dict[str, Any]] = {
    "MountainCar-v0": {"goal_velocity": [0, 0.01, 0.03]},
    "MountainCarContinuous-v0": {"goal_velocity": [0, 0.01, 0.03]},
    "CartPole-v1": {"sutton_barto_reward": [False, True]},
    "CartPole-v0": {"sutton_barto_reward": [False, True]},
    "Pendulum-v1": {"g": [10.0, 9.81, 2]},
    "FrozenLake-v1": {"is_slippery": [True, False], "map_name": ["4x4", "8x8"], "success_rate": [1 / 3, 0.7]},
    "FrozenLake8x8-v1": {"desc": [["SFHF", "FFFG"], None], "reward_schedule": [(1, 0, 0), (2.5, -1, -0.25)]},
    "CliffWalking-v1": {"is_slippery": [False, True]},
    "Taxi-v4": {"is_rainy": [False, True], "fickle_passenger": [False, True], "fickle_probability": [0.3, 1.0]},
    "Blackjack-v1": {"natural": [False, True], "sab": [False, True]},
}
NEAR_THE_END = {
    "MountainCar-v0": {"low": 0.49, "high": 0.52},
    "MountainCarContinuous-v0": {"low": 0.44, "high": 0.47},
    "CartPole-v1": {"low": -0.2},
    "Acrobot-v1": {"low": 1, "high": 2.5},
    "Pendulum-v1": {"x_init": 20.0, "y_init": 0},
}


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*CartPole-v0 is out of date")
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", IDS)
def test_lock_step_with_gymnasium(name: str, mode: Any) -> None:
    seen = np.zeros(2, np.int64)

    @settings(max_examples=max(settings().max_examples // 7, 1))
    @given(
        num_envs=st.integers(1, 24),
        seed=st.integers(0, 2**70) | st.none(),
        threads=st.sampled_from([None, 1, 2, 3]),
        copy=st.booleans(),
        limit=st.sampled_from([None, None, 1, 7, 60]),
        kwargs=st.fixed_dictionaries(
            {}, optional={key: st.sampled_from(values) for key, values in SETTINGS.get(name, {}).items()}
        ),
        options=st.sampled_from([None, {}, NEAR_THE_END.get(name, {"unknown": 1})]),
        dtype=st.sampled_from([np.float32, np.float64] if name in classic_control.CONTINUOUS else [np.int64, np.int32]),
        data=st.data(),
    )
    def run(num_envs, seed, threads, copy, limit, kwargs, options, dtype, data) -> None:
        own = {"threads": threads, "copy": copy}
        vectors = LockstepVectorEnv(name, num_envs, mode, own, max_episode_steps=limit, **kwargs)
        assert vectors.ours.unwrapped.is_native == MACHINE["NumPy calls the platform"] or not any(
            part in name for part in ("CartPole", "Acrobot", "Pendulum")
        )
        if seed is None:
            seed = data.draw(st.lists(st.integers(0, 2**40), min_size=num_envs, max_size=num_envs))
        vectors.reset(seed=seed, options=options)
        if data.draw(st.booleans()):
            mask = np.array(data.draw(st.lists(st.booleans(), min_size=num_envs, max_size=num_envs)))
            mask[data.draw(st.integers(0, num_envs - 1))] = True
            vectors.reset(seed=data.draw(st.sampled_from([None, 3])), options={"reset_mask": mask, **(options or {})})
        seen[:] += vectors.run(min(STEPS // num_envs, MAX_VECTOR_STEPS), 0 if seed is None else 1, dtype)
        vectors.same_streams()
        vectors.reset(options=NEAR_THE_END.get(name))
        seen[:] += vectors.run(3)

    run()
    # Blackjack ends before most time limits, and the examples may not include the shortest.
    cut = LockstepVectorEnv(name, 3, mode, max_episode_steps=1)
    cut.reset(seed=0)
    seen[:] += cut.run(3)
    assert seen[1] > 0
    # Random policies seldom reach the goals of the taxi and the cliff.
    assert seen[0] > 0 or name in ("Pendulum-v1", "Taxi-v4", "CliffWalking-v1", "CliffWalkingSlippery-v1")


LIMITS = {name: limit for name in IDS if (limit := gym.spec(name).max_episode_steps)}
"""The time limits, 100 to 999 steps, that environments are registered with; Blackjack and CliffWalking have none."""


@pytest.mark.filterwarnings("ignore:.*CartPole-v0 is out of date")
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", LIMITS)
def test_an_episode_is_truncated_at_the_registered_time_limit(name: str, mode: Any) -> None:
    kwargs: dict[str, Any] = {"is_slippery": False} if "FrozenLake" in name else {}
    vectors = LockstepVectorEnv(name, 2, mode, **kwargs)
    vectors.reset(seed=5)
    truncated = 0
    for step in range(LIMITS[name] + 20):
        action = lasting_action(name, vectors.theirs.envs[0].unwrapped, step)
        _, _, _, cut, _ = vectors.step(np.array([action] * 2))
        truncated += int(cut[0])
        if mode is AutoresetMode.DISABLED and vectors.over.any():
            vectors.reset(options={"reset_mask": vectors.over.copy()})
    assert truncated == 1


def lasting_action(name: str, env: Any, step: int) -> Any:
    """An action under which the first sub-environment does not terminate."""
    if name in classic_control.CONTINUOUS:
        return np.zeros(1, np.float32)
    if "CartPole" in name:  # pushes towards the centre, and the pole upright
        position, velocity, angle, turning = env.state
        return int(0.1 * position + 0.3 * velocity + 4 * angle + turning > 0)
    if "FrozenLake" in name:
        return 0  # into the wall
    return 1 if "Acrobot" in name or "MountainCar" in name else step % 2  # no force; the taxi drives to and fro


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", ["Taxi-v4", "CliffWalking-v1"])
def test_optimal_policies_reach_the_goal_in_lock_step(name: str, mode: Any) -> None:
    policy = qtab.optimum(name).policy
    vectors = LockstepVectorEnv(name, 9, mode)
    observations, _ = vectors.reset(seed=3)
    arrived = 0
    for _ in range(60):
        observations, _, terminated, _, _ = vectors.step(policy[observations].astype(np.int64))
        arrived += int(terminated.sum())
        if mode is AutoresetMode.DISABLED and terminated.any():
            observations, _ = vectors.reset(options={"reset_mask": terminated})
    assert arrived >= 18
    vectors.same_streams()

"""Stable-Baselines3 on our environments. It needs PyTorch, so it runs only when asked for: pytest -m sb3."""

import warnings
from importlib.util import find_spec
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab

pytestmark = [
    pytest.mark.sb3,
    pytest.mark.skipif(find_spec("stable_baselines3") is None, reason="needs the extra sb3"),
    pytest.mark.filterwarnings("default"),
]

REGISTERED = sorted(name for name in gym.registry if name.startswith("qtab/"))


@pytest.fixture(autouse=True)
def _one_thread() -> None:
    """Small networks learn faster in one thread, and the order of summation is fixed."""
    import torch

    torch.set_num_threads(1)


def weights(model: Any) -> dict[str, bytes]:
    return {name: weight.numpy().tobytes() for name, weight in model.policy.state_dict().items()}


@pytest.mark.parametrize("name", REGISTERED)
def test_stable_baselines3s_checker_passes(name: str) -> None:
    from stable_baselines3.common.env_checker import check_env

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it does not support Tuple observations, and recommends other action spaces
        check_env(gym.make(name))


@pytest.mark.parametrize("algorithm", ["PPO", "DQN", "A2C"])
def test_stable_baselines3_learns_the_same_as_on_gymnasiums_environment(algorithm: str) -> None:
    import stable_baselines3

    settings: dict[str, Any] = {"seed": 0, "device": "cpu"}
    settings |= {"PPO": {"n_steps": 256}, "DQN": {"learning_starts": 100}, "A2C": {}}[algorithm]
    ours, theirs = (
        getattr(stable_baselines3, algorithm)("MlpPolicy", name, **settings).learn(2_000)
        for name in ("qtab/CartPole-v1", "CartPole-v1")
    )
    assert weights(ours) == weights(theirs)


def test_stable_baselines3_learns_to_balance_the_pole() -> None:
    from stable_baselines3 import PPO
    from stable_baselines3.common.evaluation import evaluate_policy

    model = PPO("MlpPolicy", "qtab/CartPole-v1", seed=0, device="cpu", n_steps=256).learn(4_000)
    mean, _ = evaluate_policy(model, gym.make("qtab/CartPole-v1"), n_eval_episodes=5)
    assert mean > 100  # a random policy gets about 22


@pytest.mark.parametrize("name", [name.removeprefix("qtab/") for name in REGISTERED if "Bias" not in name])
def test_the_native_vec_env_equals_dummy_vec_env(name: str) -> None:
    from stable_baselines3.common.vec_env import DummyVecEnv

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # CartPole-v0 is out of date
        ours = qtab.sb3.VecEnv(name, 5, max_episode_steps=9)
        theirs = DummyVecEnv([lambda: gym.make(name, max_episode_steps=9)] * 5)
    ours.seed(3)
    theirs.seed(3)
    assert str(ours.reset()) == str(theirs.reset())
    ours.action_space.seed(0)
    for _ in range(60):
        actions = np.stack([ours.action_space.sample() for _ in range(5)])
        (one, *mine, _), (other, *expected, _) = steps = ours.step(actions), theirs.step(actions)
        assert [array.tobytes() for array in mine] == [array.tobytes() for array in expected]
        assert np.array(one).tobytes() == np.array(other).tobytes()
        assert [info.keys() for info in steps[0][3]] == [info.keys() for info in steps[1][3]]
        assert [info.keys() for info in ours.reset_infos] == [info.keys() for info in theirs.reset_infos]
    assert ours.venv.is_native


def test_ppo_learns_the_same_on_the_native_vec_env() -> None:
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import DummyVecEnv

    envs = qtab.sb3.VecEnv("CartPole-v1", 4), DummyVecEnv([lambda: gym.make("CartPole-v1")] * 4)
    ours, theirs = (PPO("MlpPolicy", env, seed=0, device="cpu", n_steps=128).learn(2_000) for env in envs)
    assert weights(ours) == weights(theirs)


def test_stable_baselines3_evaluates_a_run() -> None:
    from stable_baselines3.common.evaluation import evaluate_policy
    from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor

    run = qtab.train("CartPole-v1", seed=0, episodes=500)
    envs = VecMonitor(qtab.sb3.VecEnv("CartPole-v1", 4)), VecMonitor(DummyVecEnv([lambda: gym.make("CartPole-v1")] * 4))
    results = []
    for env in envs:
        env.seed(1)
        results.append(evaluate_policy(run, env, n_eval_episodes=8, return_episode_rewards=True))
    assert results[0] == results[1]

"""Stable-Baselines3 on our environments. It needs PyTorch, so it runs only when asked for: pytest -m sb3."""

import warnings
from importlib.util import find_spec
from typing import Any

import gymnasium as gym
import pytest

import qtab  # noqa: F401 - registers them

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

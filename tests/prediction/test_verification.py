"""Predictions are verified against their reference in NumPy where policies are given in unusual ways."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab


@pytest.mark.parametrize("behavior", ["random", lambda observation: [1 / 3] * 3])
def test_a_policy_that_is_deterministic_up_to_rounding_is_verified(behavior: Any) -> None:
    policy = np.zeros((30, 3))
    policy[:, 1] = 1 - 5e-10
    settings: Any = {"discretizer": "bins", "bins": (5, 6), "max_episode_steps": 50}
    estimates = qtab.estimate_values(
        "MountainCar-v0", policy, behavior=behavior, method="importance_sampling", episodes=20, seeds=1, **settings
    )
    assert estimates.verify().equal


def mirrored() -> gym.Env[Any, Any]:
    """The car with its position negated by a wrapper."""
    space = gym.spaces.Box(np.array([-0.6, -0.07]), np.array([1.2, 0.07]), dtype=np.float64)
    env = gym.make("MountainCar-v0")
    return gym.wrappers.TransformObservation(env, lambda at: np.array([-at[0], at[1]], np.float64), space)


@pytest.mark.parametrize("discretizer", ["bins", "tiles", "polynomial"])
def test_a_wrapped_environment_is_verified_with_its_wrapper(discretizer: Any) -> None:
    settings: dict[str, Any] = {"discretizer": discretizer, "learning_rate": 0.01, "max_episode_steps": 40}
    estimates = qtab.estimate_values(mirrored(), "random", episodes=3, **settings)
    assert estimates.verify(env=mirrored()).equal
    with pytest.raises(ValueError, match=r"^env must be given: .* its wrapper TransformObservation was made with the"):
        estimates.verify()
    for other, change in (
        ("MountainCar-v0", r"it was in the wrapper TransformObservation, and is now without a wrapper; .*"),
        ("Acrobot-v1", "it was MountainCar-v0, and is now Acrobot-v1"),
    ):
        with pytest.raises(ValueError, match=rf"^env must be that of the estimates, got another one: {change}$"):
            estimates.verify(env=gym.make(other))
    with pytest.raises(TypeError, match=r"^env must be an environment, got 'MountainCar-v0'$"):
        estimates.verify(env="MountainCar-v0")  # type: ignore[arg-type]


def test_an_environment_that_ends_episodes_earlier_is_refused() -> None:
    long = gym.make("MountainCar-v0", max_episode_steps=300)
    options: dict[str, Any] = {"discretizer": "tiles", "episodes": 1, "progress": False}
    estimates, run = qtab.estimate_values(long, "random", **options), qtab.train(long, seed=0, preset=None, **options)
    assert estimates.verify(env=long).equal
    assert qtab.verify(run, env=gym.make("MountainCar-v0").unwrapped).equal
    assert qtab.verify(run, env="MountainCar-v0").equal  # made with the time limit of the run
    for owner, verify in (("estimates", estimates.verify), ("run", lambda env: qtab.verify(run, env=env))):
        message = f"^env must have the time limit of the {owner}, 300 steps, or none, got 200$"
        with pytest.raises(ValueError, match=message):
            verify(env=gym.make("MountainCar-v0"))


def test_a_wrapper_that_can_be_made_again_is() -> None:
    env = gym.wrappers.ClipReward(gym.make("MountainCar-v0"), -0.5, 0.0)
    estimates = qtab.estimate_values(env, "random", episodes=1, discretizer="tiles", max_episode_steps=40)
    verification = estimates.verify()
    assert verification.equal
    assert repr(estimates) == "<ValueEstimates of MountainCar-v0: td, 8 of 648 features, 1 run of 1 episode>"
    assert repr(verification) == "<ValuesVerification of td in MountainCar-v0: seed 0, 1 episode, equal>"

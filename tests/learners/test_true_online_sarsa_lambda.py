"""True online Sarsa(λ) is the online λ-return algorithm (Sutton & Barto, sections 12.4 and 12.5), at every step."""

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.reference.parts.observations import discretizer

STEPS = 25


def online_lambda_return(features, rewards, alpha, discount, decay):
    """The forward view, computed again from the first step for each horizon."""
    weights = [np.zeros(features.shape[1])]
    for horizon in range(1, len(rewards) + 1):
        w = np.zeros(features.shape[1])
        for t in range(horizon):
            # G(t:h): the λ-return truncated at the horizon, each value with the weights of the step before.
            target, share = 0.0, 1.0
            for n in range(1, horizon - t + 1):
                partial = sum(discount**k * rewards[t + k] for k in range(n))
                n_step = partial + discount**n * (weights[t + n - 1] @ features[t + n])
                weight = share if n == horizon - t else (1 - decay) * share
                target += weight * n_step
                share *= decay
            w = w + alpha * (target - w @ features[t]) * features[t]
        weights.append(w)
    return weights[-1]


@pytest.mark.parametrize(("decay", "discount"), [(0.0, 1.0), (0.8, 0.9), (0.95, 1.0), (1.0, 0.99)])
def test_true_online_sarsa_lambda_equals_the_forward_view(decay, discount):
    # It always explores, so that its actions do not depend on what it has learned.
    run = qtab.train(
        "MountainCar-v0",
        algorithm="true_online_sarsa_lambda",
        trace_decay=decay,
        discount=discount,
        discretizer="tiles",
        tilings=4,
        tiles=3,
        learning_rate=0.6,
        epsilon=1.0,
        epsilon_schedule="constant",
        initial_q=0.0,
        episodes=1,
        max_episode_steps=STEPS,
        seed=5,
        record=1,
    )
    # The action drawn at the time limit is not recorded: one of the three possible actions fits.
    env = gym.make("MountainCar-v0", max_episode_steps=STEPS)
    observation, _ = env.reset(seed=5)
    visited, rewards = [], []
    rows = discretizer(env, run.config)
    for action in run.recordings[0].actions:
        visited.append((rows.rows(observation), action))
        observation, reward, *_ = env.step(action)
        rewards.append(float(reward))
    errors = []
    for last in range(3):
        features = np.zeros((STEPS + 1, run.tables[0].size))
        for t, (active, action) in enumerate([*visited, (rows.rows(observation), last)]):
            features[t, [row * 3 + action for row in active]] = 1.0
        weights = online_lambda_return(features, rewards, 0.6 / 4, discount, decay)
        errors.append(np.abs(weights - run.tables[0].ravel()).max())
    assert min(errors) < 1e-12
    assert np.abs(run.tables).max() > 0.1

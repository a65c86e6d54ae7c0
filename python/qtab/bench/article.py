"""The article's training loop: NumPy and Gymnasium's environment only."""

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.reference import agent_stream


def q_learning(
    env: gym.Env, learning: float, discount: float, epsilon: float, min_eps: float, episodes: int, seed: int
) -> tuple[NDArray[np.float64], int]:
    """Trains on MountainCar-v0 with the arguments of the article, and a seed.

    Returns:
        The Q table, (19, 15, 3), and the number of steps.
    """
    rng = agent_stream(seed, "PCG64")
    low, scale = env.observation_space.low, np.array([10, 100])  # type: ignore[attr-defined]
    n_cells = np.round((env.observation_space.high - low) * scale, 0).astype(int) + 1  # type: ignore[attr-defined]
    q = rng.uniform(-1, 1, size=(*n_cells, 3))
    reduction = (epsilon - min_eps) / episodes
    steps = 0
    for episode in range(episodes):
        state, _ = env.reset(seed=seed if episode == 0 else None)
        cell = tuple(np.round((state - low) * scale, 0).astype(int))
        done = truncated = False
        while not (done or truncated):
            if rng.random() < 1.0 - epsilon:
                action = int(np.argmax(q[cell]))
            else:
                action = int(rng.integers(0, 3))
            state, reward, done, truncated, _ = env.step(action)
            next_cell = tuple(np.round((state - low) * scale, 0).astype(int))
            if done:
                q[cell][action] = reward
            else:
                q[cell][action] += learning * (reward + discount * np.max(q[next_cell]) - q[cell][action])
            cell = next_cell
            steps += 1
        if epsilon > min_eps:
            epsilon -= reduction
    return q, steps

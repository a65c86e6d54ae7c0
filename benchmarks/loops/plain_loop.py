"""Q-learning with the settings of a preset: NumPy and Gymnasium's environment only."""

from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.config.presets import preset
from qtab.reference import agent_stream

Discretize = Callable[[Any], Any]
"""From an observation to the index of its cell in the Q table."""


def q_learning(name: str, episodes: int, seed: int) -> tuple[NDArray[np.float64], int]:
    """Trains with the settings of an environment's default preset.

    Args:
        name: The environment's id.
        episodes: The number of episodes, over which the schedules of the rates extend.
        seed: Seeds the environment and the agent.

    Returns:
        The Q table, (*cells, actions), and the number of steps.
    """
    env = gym.make(name)
    settings: Any = preset(name, None)[1]
    shape, discretize = _discretizer(env, settings)
    rng, actions = agent_stream(seed, "PCG64"), int(env.action_space.n)  # type: ignore[attr-defined]
    q = np.full((*shape, actions), settings["initial_q"])
    learning_rate, discount, epsilon = settings["learning_rate"], settings["discount"], settings["epsilon"]
    epsilon_reduction = epsilon / episodes
    learning_rate_reduction = learning_rate / episodes if settings.get("learning_rate_schedule") == "linear" else 0.0
    steps = 0
    for episode in range(episodes):
        observation, _ = env.reset(seed=seed if episode == 0 else None)
        state = discretize(observation)
        done = truncated = False
        while not (done or truncated):
            if rng.random() < 1.0 - epsilon:
                action = int(np.argmax(q[state]))
            else:
                action = int(rng.integers(0, actions))
            observation, reward, done, truncated, _ = env.step(action)
            next_state = discretize(observation)
            if done:
                q[state][action] += learning_rate * (reward - q[state][action])
            else:
                q[state][action] += learning_rate * (reward + discount * np.max(q[next_state]) - q[state][action])
            state = next_state
            steps += 1
        if epsilon > 0:
            epsilon -= epsilon_reduction
        if learning_rate > 0:
            learning_rate -= learning_rate_reduction
    return q, steps


def _discretizer(env: gym.Env[Any, Any], settings: Any) -> tuple[tuple[int, ...], Discretize]:
    """Returns the shape of the cells, and the function from observations to cells: the identity, or equal bins."""
    space: Any = env.observation_space
    if isinstance(space, gym.spaces.Discrete):
        return (int(space.n),), int
    limits = zip(*(np.array(settings[end], dtype=space.dtype) for end in ("low", "high")), strict=True)
    edges = [np.linspace(low, high, n + 1)[1:-1] for (low, high), n in zip(limits, settings["bins"], strict=True)]

    def discretize(observation: Any) -> tuple[int, ...]:
        return tuple(int(np.digitize(number, bins)) for number, bins in zip(observation, edges, strict=True))

    return tuple(settings["bins"]), discretize

"""Q-learning by a preset as a user would write it: NumPy on Gymnasium's environment, and nothing around it."""

from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.config.presets import preset
from qtab.reference import agent_stream

Cell = Callable[[Any], Any]


def q_learning(name: str, episodes: int, seed: int) -> tuple[NDArray[np.float64], int]:
    """Returns the Q table of so many episodes with the settings of an environment's own preset, and the steps taken."""
    env, (_, settings) = gym.make(name), preset(name, None)
    shape, cell = _cells(env, settings)
    rng, actions = agent_stream(seed, "PCG64"), int(env.action_space.n)  # type: ignore[attr-defined]
    q = np.full((*shape, actions), settings["initial_q"])
    learning, discount, epsilon = settings["learning_rate"], settings["discount"], settings["epsilon"]
    reduction = epsilon / episodes
    falls = learning / episodes if settings.get("learning_rate_schedule") == "linear" else 0.0
    steps = 0
    for episode in range(episodes):
        observation, _ = env.reset(seed=seed if episode == 0 else None)
        here = cell(observation)
        done = truncated = False
        while not (done or truncated):
            if rng.random() < 1.0 - epsilon:
                action = int(np.argmax(q[here]))
            else:
                action = int(rng.integers(0, actions))
            observation, reward, done, truncated, _ = env.step(action)
            there = cell(observation)
            if done:
                q[here][action] += learning * (reward - q[here][action])
            else:
                q[here][action] += learning * (reward + discount * np.max(q[there]) - q[here][action])
            here = there
            steps += 1
        if epsilon > 0:
            epsilon -= reduction
        if learning > 0:
            learning -= falls
    return q, steps


def _cells(env: gym.Env[Any, Any], settings: Any) -> tuple[tuple[int, ...], Cell]:
    """The cells of the table, and which one an observation lies in: itself, or between edges of equal width."""
    space: Any = env.observation_space
    if isinstance(space, gym.spaces.Discrete):
        return (int(space.n),), int
    limits = zip(*(np.array(settings[end], dtype=space.dtype) for end in ("low", "high")), strict=True)
    edges = [np.linspace(low, high, n + 1)[1:-1] for (low, high), n in zip(limits, settings["bins"], strict=True)]

    def cell(observation: Any) -> tuple[int, ...]:
        return tuple(int(np.digitize(number, bins)) for number, bins in zip(observation, edges, strict=True))

    return tuple(settings["bins"]), cell

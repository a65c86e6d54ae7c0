"""Episodes of an agent that are rendered."""

from collections.abc import Callable
from dataclasses import dataclass

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.rendering.agent import Agent
from qtab.results.action_values import mask_of_step
from qtab.results.run import Run


@dataclass(frozen=True)
class Episodes:
    """The results of the finished episodes."""

    returns: NDArray[np.float64]
    """(episodes,): the return of each episode."""
    lengths: NDArray[np.int64]
    """(episodes,): the number of steps of each episode."""
    terminated: NDArray[np.bool_]
    """(episodes,): whether each episode ended in a terminal state."""


def play_episodes(
    agent: Agent, env: gym.Env, episodes: int, seed: int, see: Callable[[int, int], bool] = lambda *_: True
) -> Episodes:
    """Plays episodes.

    Args:
        agent: The agent.
        env: The environment, with a time limit.
        episodes: The number of episodes.
        seed: Seeds the first reset, as :func:`qtab.evaluate` does.
        see: Called after each reset and each step with the numbers of the episode and of the step; returning
            False stops the episodes.

    Returns:
        The finished episodes.
    """
    returns, lengths, ends = list[float](), list[int](), list[bool]()
    for episode in range(episodes):
        observation, info = env.reset(seed=seed if episode == 0 else None)
        episode_return, length, over, terminated, state = 0.0, 0, False, False, None
        goes_on = see(episode, 0)
        while goes_on and not over:
            mask = None
            if isinstance(agent.source, Run):
                mask = mask_of_step(agent.source.config, env, observation, info)
            action, state = agent.act(observation, state, mask)
            observation, reward, terminated, truncated, info = env.step(action)
            episode_return += float(reward)
            length += 1
            over = bool(terminated or truncated)
            goes_on = see(episode, length)
        if over:
            returns.append(episode_return)
            lengths.append(length)
            ends.append(bool(terminated))
        if not goes_on:
            break
    return Episodes(np.array(returns, np.float64), np.array(lengths, np.int64), np.array(ends, np.bool_))

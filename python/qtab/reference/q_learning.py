"""Q-learning in plain NumPy, to be read beside the article and the book (Sutton & Barto, 2nd ed., section 6.5)."""

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab.config import Config
from qtab.reference.streams import agent_stream


def q_learning(
    env: gym.Env, config: Config, stop_after: int | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Trains on ``env`` as a resolved config says, and returns the Q table and each episode's return and length.

    Args:
        env: The environment, its time limit included.
        config: The run's config, its seed resolved.
        stop_after: Stop after so many episodes, with the schedule of the full run.
    """
    assert isinstance(env.observation_space, gym.spaces.Box)  # noqa: S101
    assert isinstance(env.action_space, gym.spaces.Discrete)  # noqa: S101
    low, high = env.observation_space.low, env.observation_space.high
    scale = np.array(config.scale)
    n_actions, first_action = int(env.action_space.n), int(env.action_space.start)
    seed = config.seed
    assert seed is not None  # noqa: S101
    rng = agent_stream(seed, config.bit_generator)

    # The Q table: one row of action values for each cell of the rounded state.
    n_cells = np.round((high - low) * scale, 0).astype(int) + 1
    if isinstance(config.initial_q, tuple):
        Q = rng.uniform(*config.initial_q, size=(*n_cells, n_actions))
    else:
        Q = config.initial_q.copy()

    def cell(observation: ArrayLike) -> tuple[int, ...]:
        # In the dtype of the space, whatever the environment hands out.
        return tuple(np.round((np.asarray(observation, dtype=low.dtype) - low) * scale, 0).astype(int))

    returns, lengths = [], []
    epsilon = config.epsilon
    reduction = (config.epsilon - config.min_epsilon) / config.episodes

    for episode in range(stop_after or config.episodes):
        observation, _ = env.reset(seed=seed if episode == 0 else None)
        state = cell(observation)
        total, length = 0.0, 0
        terminated = truncated = False

        while not (terminated or truncated):
            # Epsilon-greedy: the first of the best actions, or now and then any.
            if rng.random() < 1.0 - epsilon:
                action = int(np.argmax(Q[state]))
            else:
                action = int(rng.integers(0, n_actions))

            observation, reward, terminated, truncated, _ = env.step(first_action + action)
            next_state = cell(observation)

            # Q(S, A) <- Q(S, A) + α [R + γ max Q(S', a) - Q(S, A)]; nothing follows a terminal state.
            if terminated and config.terminal_update == "assign":
                Q[state][action] = reward
            else:
                target = float(reward) if terminated else reward + config.discount * np.max(Q[next_state])
                Q[state][action] += config.learning_rate * (target - Q[state][action])

            state = next_state
            total += float(reward)
            length += 1

        if epsilon > config.min_epsilon:
            epsilon -= reduction
        returns.append(total)
        lengths.append(length)

    return Q, np.array(returns), np.array(lengths)

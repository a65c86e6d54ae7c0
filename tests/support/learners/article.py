"""The article's code.

After G. Hayes, "Getting Started with Reinforcement Learning and Open AI Gym" (2019): the argument names, the order of
the draws and the updates are the article's. It uses the API of gym before 0.26: ``reset()`` returns the state alone,
``step()`` four values.
"""

import gymnasium as gym
import numpy as np


def QLearning(env, learning, discount, epsilon, min_eps, episodes):  # noqa: N802 - the article's name
    """Returns the average reward of each 100 episodes, and the Q table."""
    # Size of the discretized state space
    num_states = (env.observation_space.high - env.observation_space.low) * np.array([10, 100])
    num_states = np.round(num_states, 0).astype(int) + 1

    # The Q table
    Q = np.random.uniform(low=-1, high=1, size=(num_states[0], num_states[1], env.action_space.n))  # noqa: N806, NPY002

    reward_list = []
    ave_reward_list = []

    # The decrease of epsilon per episode
    reduction = (epsilon - min_eps) / episodes

    for i in range(episodes):
        done = False
        tot_reward, reward = 0, 0
        state = env.reset()

        state_adj = (state - env.observation_space.low) * np.array([10, 100])
        state_adj = np.round(state_adj, 0).astype(int)

        while done != True:  # noqa: E712 - the article's spelling
            # The next action, epsilon-greedy
            if np.random.random() < 1 - epsilon:  # noqa: NPY002
                action = np.argmax(Q[state_adj[0], state_adj[1]])
            else:
                action = np.random.randint(0, env.action_space.n)  # noqa: NPY002

            state2, reward, done, _info = env.step(action)

            state2_adj = (state2 - env.observation_space.low) * np.array([10, 100])
            state2_adj = np.round(state2_adj, 0).astype(int)

            # A terminal state
            if done and state2[0] >= 0.5:
                Q[state_adj[0], state_adj[1], action] = reward
            # A non-terminal state
            else:
                delta = learning * (
                    reward + discount * np.max(Q[state2_adj[0], state2_adj[1]]) - Q[state_adj[0], state_adj[1], action]
                )
                Q[state_adj[0], state_adj[1], action] += delta

            tot_reward += reward
            state_adj = state2_adj

        if epsilon > min_eps:
            epsilon -= reduction

        reward_list.append(tot_reward)

        if (i + 1) % 100 == 0:
            ave_reward_list.append(np.mean(reward_list))
            reward_list = []

    return ave_reward_list, Q


class OldApi:
    """Gymnasium's environment with the API that the article uses; only the first reset gets the seed."""

    def __init__(self, env: gym.Env, seed: int) -> None:
        self.env = env
        self.seed: int | None = seed
        self.observation_space = env.observation_space
        self.action_space = env.action_space

    def reset(self):
        observation, _ = self.env.reset(seed=self.seed)
        self.seed = None
        return observation

    def step(self, action):
        observation, reward, terminated, truncated, info = self.env.step(action)
        return observation, reward, terminated or truncated, info

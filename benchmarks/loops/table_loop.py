"""Q-learning on a transition table, written for Numba: Gymnasium's toy text with its default preset."""

from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from loops.numba_loops import compiled
from qtab.config.presets import preset
from qtab.reference import agent_stream


@compiled
def q_learning(
    cumulative: NDArray[np.float64],
    states: NDArray[np.int64],
    rewards: NDArray[np.float64],
    terminal: NDArray[np.bool_],
    initial: NDArray[np.float64],
    q: NDArray[np.float64],
    env_rng: np.random.Generator,
    rng: np.random.Generator,
    episodes: int,
    time_limit: int,
    learning_rate: float,
    learning_rate_reduction: float,
    discount: float,
    epsilon: float,
    epsilon_reduction: float,
) -> int:
    """Trains a Q table, (states, actions), in place, on a transition table; returns the number of steps.

    The arrays of the table are (states, actions, outcomes), with the sums of the probabilities in ``cumulative`` and
    those of the initial states in ``initial``.
    """
    steps = 0
    for _ in range(episodes):
        number, state = env_rng.random(), 0
        while state + 1 < len(initial) and initial[state] <= number:
            state += 1
        for _ in range(time_limit):
            if rng.random() < 1.0 - epsilon:
                action = int(np.argmax(q[state]))
            else:
                action = int(rng.integers(0, q.shape[1]))
            number, index = env_rng.random(), 0
            while index + 1 < cumulative.shape[2] and cumulative[state, action, index] <= number:
                index += 1
            next_state, reward = states[state, action, index], rewards[state, action, index]
            done = terminal[state, action, index]
            target = reward if done else reward + discount * np.max(q[next_state])
            q[state, action] += learning_rate * (target - q[state, action])
            state = next_state
            steps += 1
            if done:
                break
        if epsilon > 0:
            epsilon -= epsilon_reduction
        if learning_rate > 0:
            learning_rate -= learning_rate_reduction
    return steps


def arguments(name: str, episodes: int) -> Callable[[int], tuple[Any, ...]]:
    """Returns a function from a seed to the arguments of :func:`q_learning`, with the default preset.

    The arrays of the environment are made once; each call makes a new Q table and new random generators.
    """
    env: Any = gym.make(name)
    table, settings = env.unwrapped.P, dict[str, Any](preset(name, None)[1])
    outcomes = max(len(row) for pairs in table.values() for row in pairs.values())
    shape = (len(table), len(table[0]), outcomes)
    cumulative, rewards = np.ones(shape), np.zeros(shape)
    states, terminal = np.zeros(shape, np.int64), np.zeros(shape, np.bool_)
    for state, pairs in table.items():
        for action, row in pairs.items():
            cumulative[state, action, : len(row)] = np.cumsum([outcome[0] for outcome in row])
            for index in range(outcomes):  # of pairs with fewer outcomes, the last is repeated
                _, next_state, reward, done = row[min(index, len(row) - 1)]
                states[state, action, index] = next_state
                rewards[state, action, index] = reward
                terminal[state, action, index] = done
    arrays = (cumulative, states, rewards, terminal, np.cumsum(env.unwrapped.initial_state_distrib))
    learning_rate, epsilon = settings["learning_rate"], settings["epsilon"]
    falls = settings.get("learning_rate_schedule") == "linear"
    numbers = (
        *(episodes, env.spec.max_episode_steps),
        *(learning_rate, learning_rate / episodes if falls else 0.0, settings["discount"]),
        *(epsilon, epsilon / episodes),
    )

    def with_seed(seed: int) -> tuple[Any, ...]:
        q = np.full(shape[:2], float(settings["initial_q"]))
        env_rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed)))
        return *arrays, q, env_rng, agent_stream(seed, "PCG64"), *numbers

    return with_seed

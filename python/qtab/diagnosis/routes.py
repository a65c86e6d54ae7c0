"""The length of the best policy's path to a goal."""

from qtab.config import Config
from qtab.planning.optimum import Optimum
from qtab.training.setup.run_env import make_run_env

EPISODES = 20
MOST_STEPS = 20_000
"""The largest number of steps to play, which takes tens of milliseconds in Python."""


def shortest_best_episode(config: Config, optimum: Optimum) -> int | None:
    """Returns the fewest steps in which the best policy ends an episode that is at least as good as its average.

    Args:
        config: The config of a run in the environment.
        optimum: Its exact optimum.

    Returns:
        The number of steps; None if none of 20 episodes ends like this, as in a continuing task.
    """
    env, lengths, steps = make_run_env(config), [], 0
    try:
        for seed in range(EPISODES):
            observation, _ = env.reset(seed=seed)
            state, total, length, over = None, 0.0, 0, False
            while not over and steps < MOST_STEPS:
                action, state = optimum.predict(observation, state)
                observation, reward, terminated, truncated, _ = env.step(action)
                total, length, steps = total + float(reward), length + 1, steps + 1
                over = terminated or truncated
                if terminated and total >= optimum.expected_return - 1e-9:
                    lengths.append(length)
    finally:
        env.close()
    return min(lengths, default=None)

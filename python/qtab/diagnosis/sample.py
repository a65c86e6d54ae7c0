"""Episodes played for a diagnosis: the last steps of a run, repeated, and the shortest episode of the best policy."""

from contextlib import closing
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.envs.actions import flat
from qtab.planning.optimum import Optimum
from qtab.results.run import Run
from qtab.results.run_state import restored_generator
from qtab.results.time_steps import rows_of
from qtab.training.setup.run_env import make_run_env
from qtab.training.train import train

SAMPLE_STEPS = 20_000
"""The number of steps to replay, which takes tens of milliseconds."""


@dataclass(frozen=True)
class Sample:
    """Consecutive steps of the last episodes."""

    rows: NDArray[np.int64]
    """(steps, n_active): the active rows of the state."""
    columns: NDArray[np.int64]
    """(steps,): the column of the action."""
    next_rows: NDArray[np.int64]
    """(steps, n_active): the active rows of the next state."""
    rewards: NDArray[np.float64]
    """(steps,): the reward of each step."""
    observations: NDArray[Any]
    """(steps, ...): the state's observation."""
    space: Any
    """The observation space."""

    @property
    def mixed_outcomes(self) -> float:
        """The share of steps whose state and action had another next state or reward at another step."""
        _, pairs = np.unique(np.column_stack([self.rows, self.columns]), axis=0, return_inverse=True)
        _, ends = np.unique(np.column_stack([self.next_rows, self.rewards]), axis=0, return_inverse=True)
        kinds = np.unique(np.column_stack([pairs, ends]), axis=0)[:, 0]
        return float(np.mean(np.bincount(kinds)[pairs] > 1))


def repeat(run: Run) -> Run:
    """Repeats a run in Rust, counting its visits and recording its last episodes."""
    lengths = run.episode_lengths[::-1].cumsum()
    episodes = max(1, int(np.searchsorted(lengths, SAMPLE_STEPS, side="right")))
    finished = len(run.episode_returns)
    return train(
        config=run.config,
        record=episodes,
        visits=True,
        progress=False,
        callback=lambda progress: progress.episodes < finished,
        callback_every=finished,
    )


def sample_steps(run: Run) -> Sample:
    """Replays the recordings of a run."""
    visited, taken, following, rewards, steps = [], [], [], [], []
    with closing(make_run_env(run.config)) as env:
        plain: Any = env.unwrapped
        for recording in run.recordings:
            plain.np_random = restored_generator(recording.start)
            observation, _ = plain.reset()
            for step, action in enumerate(recording.actions[:SAMPLE_STEPS]):
                steps.append(step)
                visited.append(observation)
                taken.append(action)
                observation, reward, *_ = plain.step(action)
                following.append(observation)
                rewards.append(float(reward))
    observations = np.array(visited)
    before = np.array(steps, np.int64)
    known = np.array([flat(run.actions[column]) for column in range(len(run.actions))])
    columns = (
        (np.array([flat(action) for action in taken]).reshape(-1, 1, known.shape[1]) == known)
        .all(axis=-1)
        .argmax(axis=-1)
    )
    rows, next_rows = rows_of(run, observations, before), rows_of(run, np.array(following), before + 1)
    return Sample(rows, columns, next_rows, np.array(rewards), observations, env.observation_space)


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
    lengths, steps = [], 0
    with closing(make_run_env(config)) as env:
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
    return min(lengths, default=None)

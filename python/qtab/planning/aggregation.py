"""The best policy known on the cells of a run: dynamic programming on the task as its discretizer shows it.

All states of a cell are treated as one state, whose transitions are the mean of theirs (hard aggregation: D. Bertsekas
and J. Tsitsiklis, "Neuro-Dynamic Programming", 1996, section 3.1.2).
"""

import dataclasses
from contextlib import closing
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.discretizers.edges import Edges
from qtab.discretizers.rounding import Rounding
from qtab.planning.grid_environments import GridEnvironment, even_points
from qtab.results.run import Run
from qtab.training.setup.run_env import make_run_env

SAMPLES_PER_CELL = 30
MOST_SAMPLES = 60_000
"""The number of sampled states, evenly spread over the range of the states; each is stepped with each action."""


def aggregated_run(run: Run, known: GridEnvironment, axes: tuple[NDArray[np.float64], ...]) -> Run | None:
    """Returns a run with the action values of its task on cells; None without cells, or with too many to sample each.

    Args:
        run: A run in the environment.
        known: The description of the environment.
        axes: The coordinates of a grid over the environment's states, which define their range.
    """
    if not isinstance(run.discretizer, Rounding | Edges) or run.tables.shape[1] > MOST_SAMPLES:
        return None
    tables = np.zeros_like(run.tables)
    tables[0] = _action_values(run, known, axes)
    return dataclasses.replace(run, tables=tables)


def _action_values(run: Run, known: GridEnvironment, axes: tuple[NDArray[np.float64], ...]) -> NDArray[np.float64]:
    """Returns (rows, actions): the undiscounted values with all steps of the time limit to go."""
    shape = run.tables.shape[1:]
    count = min(SAMPLES_PER_CELL * shape[0], MOST_SAMPLES)
    states = even_points([axis[0] for axis in axes], [axis[-1] for axis in axes], count)
    cells = run.discretizer.active_rows(known.observations_of(states))[:, 0].astype(np.int64)
    following, rewards, terminated = _steps(run, states)
    pairs = (cells[:, np.newaxis] * shape[1] + np.arange(shape[1])).ravel()
    visits = np.maximum(np.bincount(pairs, minlength=shape[0] * shape[1]), 1)
    mean_rewards = np.bincount(pairs, rewards, len(visits)) / visits
    continues = ~terminated
    outcomes, counts = np.unique(np.stack((pairs[continues], following[continues])), axis=1, return_counts=True)
    probabilities = counts / visits[outcomes[0]]
    values = np.zeros(shape[0])
    for _ in range(run.config.max_episode_steps or 0):
        expected = np.bincount(outcomes[0], probabilities * values[outcomes[1]], len(visits))
        action_values = (mean_rewards + expected).reshape(shape)
        before, values = values, action_values.max(axis=1)
        if np.array_equal(before, values):
            break
    return action_values


def _steps(run: Run, states: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.bool_]]:
    """Steps each state with each action. Returns (states * actions,) rows, rewards, and whether the episode ends."""
    with closing(make_run_env(run.config)) as env:
        env.reset(seed=0)
        plain: Any = env.unwrapped
        observations, rewards, terminated = [], [], []
        for state in states.tolist():
            for action in run.actions.take(np.arange(run.tables.shape[-1])):
                plain.state = np.array(state)
                if hasattr(plain, "steps_beyond_terminated"):
                    plain.steps_beyond_terminated = None  # CartPole sets it when an episode has ended
                observation, reward, ended, _, _ = plain.step(action)
                observations.append(observation)
                rewards.append(float(reward))
                terminated.append(bool(ended))
    rows = run.discretizer.active_rows(np.array(observations))[:, 0].astype(np.int64)
    return rows, np.array(rewards), np.array(terminated)

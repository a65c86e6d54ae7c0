"""Example 6.5: Sarsa on the windy grid world."""

import numpy as np

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.runner import EpisodeLog, FloatArray
from qtab.book.setting import Setting, episodes_by
from qtab.envs.grid_worlds import windy_grid_world

STEPS = 8000
"""The last time step of the book's figure."""
SHORTEST_PATH = 15
LAST_STEPS = 1000

_SARSA = {
    "algorithm": "sarsa",
    "learning_rate": 0.5,
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    # No run can finish more episodes in so many steps.
    "episodes": STEPS // SHORTEST_PATH + 1,
}
_TIMES = tuple(range(200, STEPS + 1, 200))


def last_lengths(log: EpisodeLog) -> FloatArray:
    """Returns (runs, 1): the mean length of the episodes that end within the last 1,000 of the 8,000 steps."""
    ends = log.lengths.cumsum(axis=1)
    late = (ends > STEPS - LAST_STEPS) & (ends <= STEPS)
    means: FloatArray = np.where(late, log.lengths, 0).sum(axis=1, keepdims=True) / late.sum(axis=1, keepdims=True)
    return means


EXPERIMENT = TrainingExperiment(
    name="example-6.5",
    title="Sarsa on the windy grid world",
    book="ε = 0.1, α = 0.5, initial values of zero; the figure shows one run of 8,000 steps",
    unspecified="how ties are broken (at random here). One run has no standard error, so the default is 100 runs",
    settings=(
        Setting("episodes finished", windy_grid_world, _SARSA, episodes_by(_TIMES), x=_TIMES),
        Setting("steps per episode, last 1,000", windy_grid_world, _SARSA, last_lengths, x=(STEPS,), drawn=False),
    ),
    runs=100,
    x_label="time steps",
    y_label="episodes",
    table_x=(1000, 2000, 4000, 6000, 8000),
)

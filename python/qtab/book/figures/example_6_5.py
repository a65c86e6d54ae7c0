"""Example 6.5: Sarsa on the windy grid world."""

import numpy as np

from qtab.book.experiment import Experiment, Numbers, Setting
from qtab.book.measures import episodes_by
from qtab.book.trials import Outcome
from qtab.envs.grid_worlds import windy_grid_world

STEPS = 8000
"""As far as the book's picture goes."""
SHORTEST = 15
LAST = 1000

_SARSA = {
    "algorithm": "sarsa",
    "learning_rate": 0.5,
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    # As many as could be finished in so many steps.
    "episodes": STEPS // SHORTEST + 1,
}
_TIMES = tuple(range(200, STEPS + 1, 200))


def last_lengths(outcome: Outcome) -> Numbers:
    """Returns how long the episodes are on average that end within the last 1,000 of the 8,000 steps."""
    ends = outcome.lengths.cumsum(axis=1)
    late = (ends > STEPS - LAST) & (ends <= STEPS)
    means: Numbers = np.where(late, outcome.lengths, 0).sum(axis=1, keepdims=True) / late.sum(axis=1, keepdims=True)
    return means


EXPERIMENT = Experiment(
    name="example-6.5",
    title="Sarsa on the windy grid world",
    book="ε = 0.1, α = 0.5, values of zero; the picture shows one run of 8,000 steps",
    silent="how ties are broken (at random here). Of one run there is no standard error: 100 are the default",
    settings=(
        Setting("episodes finished", windy_grid_world, _SARSA, episodes_by(_TIMES), x=_TIMES),
        Setting("steps an episode, last 1,000", windy_grid_world, _SARSA, last_lengths, x=(STEPS,), drawn=False),
    ),
    runs=100,
    x="time steps",
    y="episodes",
    shown=(1000, 2000, 4000, 6000, 8000),
)

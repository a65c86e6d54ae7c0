"""A picture of the exploration and the learning rate over a run."""

from typing import TYPE_CHECKING

import numpy as np

from qtab._utils import checks
from qtab.config.schedules import ByVisits, Softmax, Ucb, learning_rate
from qtab.config.schedules import policy as policy_of
from qtab.plots.parts.axes import axes_or_new
from qtab.plots.parts.colors import color
from qtab.plots.parts.labels import check_title, earlier_limits, finish, set_x_limits
from qtab.results.rates import rates_of
from qtab.results.run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_POINTS = 2_000
"""The largest number of points; of more episodes, evenly spaced ones are drawn."""


def schedule(run: Run, ax: "Axes | None" = None, *, title: str | None = None) -> "Axes":
    """Draws the exploration rate ε, or the temperature τ or the confidence c, and the learning rate α in each episode.

    The episodes are the finished ones, at least one, with the rates that they had: if a run was resumed with more
    episodes while a rate fell, the line jumps. A learning rate that falls with the visits of a state and action is not
    a function of the episode: a band shows its range, from the value at the first visit down to the minimum.

    Args:
        run: The run.
        ax: The axes to draw on; None creates a new figure.
        title: The title; None names the environment.

    Returns:
        The axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: if ``run`` is not a Run.
    """
    checks.instance("run", run, Run)
    check_title(title)
    ax = axes_or_new(ax)
    earlier = earlier_limits(ax)
    config = run.config
    finished = max(len(run.episode_returns), 1)
    episodes = np.unique(np.linspace(0, finished - 1, MAX_POINTS).astype(np.int64))
    behaviour = policy_of(config)
    if isinstance(behaviour, Softmax):
        ax.axhline(
            behaviour.temperature, color=color(0), linewidth=2, label=f"temperature τ = {behaviour.temperature:g}"
        )
    elif isinstance(behaviour, Ucb):
        label = f"confidence c = {behaviour.confidence:g}"
        ax.axhline(behaviour.confidence, color=color(0), linewidth=2, label=label)
    else:
        rates = rates_of(run, behaviour.epsilon, episodes)
        ax.plot(episodes + 1, rates, color=color(0), linewidth=2, label="exploration rate ε")
    rate = learning_rate(config)
    if isinstance(rate, ByVisits):
        label = f"learning rate α = {rate.value:g} / visits of the pair"
        ax.axhspan(rate.minimum, rate.value, color=color(1), alpha=0.25, linewidth=0, label=label)
    else:
        rates = rates_of(run, rate, episodes)
        shared = 1 if run.discretizer.is_weighted else run.discretizer.n_active
        label = "learning rate α" if shared == 1 else f"learning rate α, divided among {shared} tilings"
        ax.plot(episodes + 1, rates, color=color(1), linewidth=2, linestyle="--", label=label)
    set_x_limits(ax, 1, max(finished, 2), earlier)
    ax.set_ylim(bottom=0)
    ax.margins(y=0.08)
    ax.xaxis.set_major_formatter("{x:,.0f}")
    return finish(ax, "episode", "rate", config.env if title is None else title)

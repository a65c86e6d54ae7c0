"""``qtab.plot``: the learning curve of a single run."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab._utils.shown import counted
from qtab.config.schedules import ByVisits, EpsilonGreedy, Linear, Schedule, learning_rate, policy
from qtab.envs.metadata.goals import threshold_of
from qtab.plots.parts.axes import axes_or_new, check_axes, new_figure, save_figure
from qtab.plots.parts.colors import palette
from qtab.plots.parts.labels import earlier_limits, episode_ticks, finish, set_x_limits
from qtab.plots.parts.marks import check_optimum, check_threshold, fitting_block, mark_optimum, mark_threshold
from qtab.results.rates import rates_of
from qtab.results.run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum

DOTS_PER_INCH = 150
MAX_DOTS = 20_000
"""The largest number of dots; of more episodes, evenly spaced ones are drawn."""


def plot(
    run: Run,
    ax: "Axes | None" = None,
    *,
    block: int | None = None,
    color: Any = None,
    optimum: "Optimum | float | None" = None,
    threshold: float | Literal[False] | None = None,
) -> "Axes":
    """Draws the mean return of each block of episodes as a line, and the return of each episode as a dot.

    Args:
        run: The run. :func:`qtab.plots.learning_curves` draws several.
        ax: The axes to draw on; None creates a new figure, which a notebook and ``plt.show()`` show.
        block: The number of episodes in a block. None means 100; more for a run of more than 10,000 episodes, and
            fewer for one of fewer than 2,000.
        color: The color; None means that of the algorithm.
        optimum: A result of :func:`qtab.optimum`, or a return, to mark by a dashed line with its number in the legend.
        threshold: A return to mark by a dotted line. None means that at which Gymnasium considers the environment
            solved, if it is known and not far from the returns; False means no line.

    Returns:
        The axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, such as a block longer than the run.
    """
    if hasattr(run, "mean_returns") and not isinstance(run, Run):
        raise TypeError(f"run must be a Run, got {run!r}; qtab.plots.learning_curves draws many")
    checks.instance("run", run, Run)
    check_axes(ax)
    check_optimum(optimum)
    check_threshold(threshold)
    finished = len(run.episode_returns)
    if block is None:
        block = fitting_block(finished)
    else:
        block = checks.integer("block", block, least=1, most=max(finished, 1))
    ax = axes_or_new(ax)
    earlier = earlier_limits(ax)
    [hue] = palette([run.config.algorithm], ax, None, color)
    episodes = np.arange(finished)
    if finished > MAX_DOTS:
        episodes = np.linspace(0, finished - 1, MAX_DOTS).astype(np.int64)
    ax.plot(
        episodes + 1,
        run.episode_returns[episodes],
        linestyle="none",
        marker=".",
        markersize=5,
        markeredgewidth=0,
        color=hue,
        alpha=max(0.3, min(0.8, 5 / math.sqrt(max(finished, 1)))),
        label="one episode",
        rasterized=True,
    )
    _draw_means(ax, run.mean_returns(block), block, hue)
    set_x_limits(ax, 0, max(finished, 1), earlier)
    mark_optimum(ax, optimum)
    mark_threshold(ax, threshold, threshold_of(run.config))
    episode_ticks(ax)
    return finish(ax, "episode", "return", run.config.env, note=_settings_note(run))


def _draw_means(ax: "Axes", means: NDArray[np.float64], block: int, hue: Any) -> None:
    """Draws the (blocks,) means, each at the end of its block, as in the article."""
    if len(means):
        marker: dict[str, Any] = {"marker": "o", "markersize": 5} if len(means) == 1 else {}
        episodes, label = block * (np.arange(len(means)) + 1), f"mean of {counted(block, 'episode')}"
        ax.plot(episodes, means, color=hue, linewidth=2.2, solid_capstyle="round", label=label, **marker)


def _settings_note(run: Run) -> str:
    """Returns the learning rate, the discount, the exploration and the seed; rates that fall as in a schedule."""
    config = run.config
    rate = learning_rate(config)
    if isinstance(rate, ByVisits):
        least = f", ≥ {rate.minimum:g}" if rate.minimum > 0 else ""
        step_size = f"α = {rate.value:g} / visits{least}"
    else:
        step_size = f"α = {_falling(run, rate)}"
    if config.temperature is not None:
        exploration = f"τ = {config.temperature:g}"
    elif config.confidence is not None:
        exploration = f"c = {config.confidence:g}"
    else:
        behaviour = policy(config)
        exploration = f"ε = {_falling(run, behaviour.epsilon) if isinstance(behaviour, EpsilonGreedy) else '0'}"
    return f"{step_size}, γ = {config.discount:g}, {exploration}, seed {config.seed}"


def _falling(run: Run, rate: Schedule) -> str:
    """Returns a rate as text: ``"0.5"``, or ``"0.5 → 0.1"`` for one that falls to 0.1 in the last episode.

    A linear schedule that ended is named by the value that it reaches after the last episode.
    """
    first, finished = f"{rate.value:g}", len(run.episode_returns)
    if isinstance(rate, Linear) and run.completed:
        last = f"{min(rate.minimum, rate.value):g}"
    elif finished:
        [used] = rates_of(run, rate, np.array([finished - 1]))
        last = f"{used:.3g}" if used < rate.value else first
    else:
        last = first
    return first if last == first else f"{first} → {last}"


def save_plot(run: Run, path: Path, optimum: "Optimum | None" = None) -> None:
    """Writes the learning curve to a file, completely or not at all, in the format of its suffix.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        OSError: if the file cannot be written.
    """
    figure = new_figure()
    plot(run, figure.subplots(), optimum=optimum)
    save_figure(figure, path, DOTS_PER_INCH)

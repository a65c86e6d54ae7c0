"""``qtab.plot``: the learning curve of a single run."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from qtab._utils import checks
from qtab.plots.axes import axes_or_new, mark_optimum, new_figure, save_figure
from qtab.results.run import Run
from qtab.results.summary import default_block

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum

DOTS_PER_INCH = 150
MAX_DOTS = 20_000
"""A run with more episodes than this shows evenly spaced ones only."""


def plot(
    run: Run, ax: "Axes | None" = None, *, block: int | None = None, optimum: "Optimum | float | None" = None
) -> "Axes":
    """Draws the mean return of each block of episodes as a line, and the return of each episode as a dot.

    Args:
        run: The run.
        ax: The axes to draw on; None creates a new figure.
        block: The number of episodes in a block; None means 100, or more for a run of more than 10,000 episodes.
        optimum: A result of :func:`qtab.optimum`, or a return, to mark by a dashed line with its number in the legend.

    Returns:
        The axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: if ``block`` is less than one.
    """
    checks.instance("run", run, Run)
    if block is None:
        block = default_block(len(run.episode_returns))
    means = run.mean_returns(block)
    ax = axes_or_new(ax)
    episodes = np.arange(len(run.episode_returns))
    if len(episodes) > MAX_DOTS:
        episodes = np.linspace(0, len(episodes) - 1, MAX_DOTS).astype(np.int64)
    ax.plot(
        episodes + 1,
        run.episode_returns[episodes],
        linestyle="none",
        marker=".",
        markersize=5,
        markeredgewidth=0,
        color="tab:blue",
        alpha=0.3,
        label="one episode",
        rasterized=True,
    )
    if len(means) > 0:
        # Each mean is drawn at the end of its block, as in the article.
        ax.plot(
            block * (np.arange(len(means)) + 1),
            means,
            color="#0b3c6f",
            linewidth=2.2,
            solid_capstyle="round",
            label=f"mean of {block:,} episode{'' if block == 1 else 's'}",
        )
    mark_optimum(ax, optimum)
    ax.set_xlabel("Episode")
    ax.set_ylabel("Return")
    ax.set_title(run.config.env, loc="left", fontweight="bold")
    ax.set_title(_settings_note(run), loc="right", fontsize="small", color="0.35")
    ax.set_xlim(0, max(len(run.episode_returns), 1))
    ax.xaxis.set_major_formatter("{x:,.0f}")
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    # Below the axes: a run that learns early fills their upper part.
    legend = ax.legend(loc="upper left", bbox_to_anchor=(0.0, -0.12), ncols=3, frameon=False, markerscale=2)
    for handle in legend.legend_handles:
        if handle is not None:
            handle.set_alpha(1)
    return ax


def _settings_note(run: Run) -> str:
    config = run.config
    if config.temperature is not None:
        exploration = f"τ = {config.temperature:g}"
    else:
        exploration = f"ε = {config.epsilon:g}"
        if config.min_epsilon is not None:
            exploration += f" → {config.min_epsilon:g}"
    return f"α = {config.learning_rate:g}, γ = {config.discount:g}, {exploration}, seed {config.seed}"


def save_plot(run: Run, path: Path, optimum: "Optimum | None" = None) -> None:
    """Draws the learning curve to a file, completely or not at all; the suffix determines the format.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        OSError: if the file cannot be written.
    """
    figure = new_figure()
    plot(run, figure.subplots(), optimum=optimum)
    save_figure(figure, path, DOTS_PER_INCH)

"""The learning curve."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab._utils import checks
from qtab._utils.extras import missing
from qtab._utils.files import replacing
from qtab.plots.axes import mark_optimum
from qtab.results.run import Run
from qtab.results.summary import default_block

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.planning import Optimum

DOTS_PER_INCH = 150
LARGEST_CLOUD = 20_000
"""More single episodes than this are thinned out: more dots would only darken the cloud."""


def plot(
    run: Run, ax: "Axes | None" = None, *, block: int | None = None, optimum: "Optimum | float | None" = None
) -> "Axes":
    """Draws the average return of each block of episodes, as the article does, over the single returns.

    Args:
        run: What to draw.
        ax: Where to draw; None makes a figure of its own.
        block: How many episodes an average is taken over; None takes 100, and more in a run of more than 10,000.
        optimum: What :func:`qtab.optimum` found, or a return: a dashed line, its number in the legend.

    Returns:
        The axes that were drawn on.

    Raises:
        ModuleNotFoundError: without matplotlib; it names the ``pip install``.
        TypeError: if ``run`` is no :class:`qtab.Run`, ``block`` no integer or ``optimum`` neither of the two.
        ValueError: if ``block`` is less than one.
    """
    checks.instance("run", run, Run)
    if block is None:
        block = default_block(len(run.episode_returns))
    means = run.mean_returns(block)
    if ax is None:
        ax = _figure().subplots()
    episodes = np.arange(len(run.episode_returns))
    if len(episodes) > LARGEST_CLOUD:
        episodes = np.linspace(0, len(episodes) - 1, LARGEST_CLOUD).astype(np.int64)
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
        # A mean stands at the end of its block, as the article's does.
        ax.plot(
            block * (np.arange(len(means)) + 1),
            means,
            color="#0b3c6f",
            linewidth=2.2,
            solid_capstyle="round",
            label=f"mean of {block:,} episodes",
        )
    mark_optimum(ax, optimum)
    ax.set_xlabel("Episode")
    ax.set_ylabel("Return")
    ax.set_title(run.config.env, loc="left", fontweight="bold")
    ax.set_title(_note(run), loc="right", fontsize="small", color="0.35")
    ax.set_xlim(0, max(len(run.episode_returns), 1))
    ax.xaxis.set_major_formatter("{x:,.0f}")
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    # Below: a curve that learns soon leaves no room above.
    legend = ax.legend(loc="upper left", bbox_to_anchor=(0.0, -0.12), ncols=3, frameon=False, markerscale=2)
    for handle in legend.legend_handles:
        if handle is not None:
            handle.set_alpha(1)
    return ax


def _note(run: Run) -> str:
    config = run.config
    return (
        f"α = {config.learning_rate:g}, γ = {config.discount:g}, ε = {config.epsilon:g} → {config.min_epsilon:g}, "
        f"seed {config.seed}"
    )


def check_format(name: str, path: Path) -> None:
    """Refuses a file whose ending is no format that matplotlib writes.

    Raises:
        ModuleNotFoundError: without matplotlib; it names the ``pip install``.
        ValueError: names the argument, the path and the endings that there are.
    """
    formats = sorted(_figure().canvas.get_supported_filetypes())
    if path.suffix.lower().removeprefix(".") not in formats:
        raise ValueError(f"{name} must end in one of .{', .'.join(formats)}, got {str(path)!r}")


def save_plot(run: Run, path: Path, optimum: "Optimum | None" = None) -> None:
    """Draws the learning curve to a file, whole or not at all; its ending gives the format.

    Raises:
        ModuleNotFoundError: without matplotlib; it names the ``pip install``.
        OSError: if the file cannot be written.
    """
    figure = _figure()
    plot(run, figure.subplots(), optimum=optimum)
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=DOTS_PER_INCH)


def _figure() -> Any:
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise missing(error, "plot") from None
    return Figure(figsize=(8, 4.5), layout="constrained")

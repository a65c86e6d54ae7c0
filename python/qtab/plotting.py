"""The learning curve."""

from typing import TYPE_CHECKING

import numpy as np

from qtab.extras import missing
from qtab.run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot(run: Run, ax: "Axes | None" = None, *, block: int = 100) -> "Axes":
    """Draws the average return of each block of episodes, as the article does, over the single returns.

    Args:
        run: What to draw.
        ax: Where to draw; None makes a figure of its own.
        block: How many episodes an average is taken over.

    Returns:
        The axes that were drawn on.

    Raises:
        ModuleNotFoundError: without matplotlib; it names the ``pip install``.
    """
    if ax is None:
        try:
            from matplotlib.figure import Figure
        except ModuleNotFoundError as error:
            raise missing(error, "plot") from None
        ax = Figure(figsize=(8, 5), layout="constrained").subplots()
    means = run.mean_returns(block)
    ax.plot(
        np.arange(len(run.episode_returns)) + 1,
        run.episode_returns,
        linestyle="none",
        marker=".",
        markersize=2,
        color="tab:blue",
        alpha=0.25,
        label="episode",
    )
    ax.plot(
        block * (np.arange(len(means)) + 1), means, color="tab:blue", linewidth=2, label=f"mean of {block} episodes"
    )
    ax.set_xlabel("Episode")
    ax.set_ylabel("Return")
    ax.set_title(f"{run.config.env}, seed {run.config.seed}")
    ax.grid(alpha=0.3)
    ax.legend(loc="lower right")
    return ax

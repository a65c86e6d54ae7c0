"""A picture of the states in which a policy differs from an optimal one, and of the cost."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab.envs.registry import bare_id
from qtab.planning.optimum import Optimum, as_solved
from qtab.plots.arrangements import Raster, arrange
from qtab.plots.arrangements.grid_map import Layout
from qtab.plots.parts.colors import is_dark
from qtab.plots.parts.labels import check_title, joined
from qtab.plots.parts.panels import axes_for, color_bar, draw_cells, finish_panel, shade_unknown, write_numbers
from qtab.plots.parts.subject import Subject, subject_of
from qtab.results.run import Run
from qtab.results.runs import Runs

if TYPE_CHECKING:
    from matplotlib.axes import Axes

EXACT = 1e-9
"""A smaller cost, relative to the values of the two actions, is a tie between them."""
CANCELLED = 1e-14
"""A smaller cost, relative to the largest value of all states, is a rounding error where rewards cancel to 0."""
ZERO = 16
"""The number of colors of the bar, of 256, that stand for a cost of 0."""
FEWEST_DIGITS, MOST_DIGITS = 1e-3, 1e7
"""Costs between these are written without an exponent beside the color bar."""
APPROXIMATE = 1.0
"""For MountainCar's values, which are interpolated in a grid, a cost of up to one step counts as 0."""


def difference(
    run: Run | Runs,
    optimum: Optimum,
    ax: "Axes | None" = None,
    *,
    at: Mapping[str, float] | None = None,
    layout: Layout | None = None,
    title: str | None = None,
) -> "Axes":
    """Draws the cost of the greedy action in each state: the optimal value that it gives away, V*(s) - Q*(s, a).

    The cost is that of a single action, followed by optimal ones. It is 0 if the action is optimal, or one of several
    optimal ones; these states stay blank. States in which the run has learned nothing are grey, as in
    :func:`qtab.plots.values`. States that the policy never visits count as well: a policy can be optimal although some
    states have a worse action. For MountainCar the values are those of the best known policy, accurate to about a step:
    lower costs count as 0.

    Args:
        run: A run, or the runs of many seeds with their tables, whose most frequent greedy action is taken.
        optimum: The result of :func:`qtab.optimum` for the environment, or for the table that :func:`qtab.tabulate`
            made of it.
        ax: The axes to draw on; None creates a new figure.
        at: For observations of more than two components, the values of those that are not axes; see
            :func:`qtab.plots.values`.
        layout: A map for numbered states; see :func:`qtab.plots.values`.
        title: The title; None names the environment and the optimum.

    Returns:
        The axes.

    Raises:
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        TypeError: for an argument of the wrong type.
        ValueError: if the optimum is that of another environment, or of one with other arguments or changes, or an
            argument does not fit it.
    """
    if not isinstance(run, Run | Runs):
        raise TypeError(f"run must be a Run or Runs, got {run!r}")
    if not isinstance(optimum, Optimum):
        raise TypeError(f"optimum must be a result of qtab.optimum, got {optimum!r}")
    check_title(title)
    env = run.config.env
    subject, best = subject_of("run", as_solved(optimum, run)), subject_of("optimum", optimum)
    _check_same(subject, best)
    if not subject.discretizer.has_component_axes:
        raise ValueError(
            "run must have a table of the components of its observations, not of a function or of max_rows"
        )
    raster = arrange(subject, at, layout, sampled=optimum.search is not None)
    cost = costs(subject, best, raster)
    [ax] = axes_for([raster], ax)
    from matplotlib import colormaps  # after the axes, whose error without matplotlib names the extra
    from matplotlib.colors import ListedColormap, Normalize, to_rgba

    known = np.isfinite(cost)
    wrong = known & (cost > 0)
    share = wrong.sum() / max(known.sum(), 1)
    if title is None:
        policy = "an optimal policy" if optimum.exact else "the best known policy"
        title = f"{env}: cost against {policy}"
    shade_unknown(ax, raster, cost)
    # The end of the map that looks like the background is left out; 0 is the background itself.
    costly = colormaps["magma" if is_dark(ax) else "magma_r"](np.linspace(0.25, 1.0, 256))
    background = np.broadcast_to(to_rgba(ax.get_facecolor()), (ZERO, 4))
    cmap = ListedColormap(np.concatenate([background, costly]))
    # A few states of very high costs would leave all others pale.
    highest = float(np.quantile(cost[wrong], 0.99)) if wrong.any() else 1.0
    lowest = -highest * ZERO / len(costly)
    norm = Normalize(lowest, highest)
    image = draw_cells(ax, raster, np.where(wrong, cost, np.nan), cmap, norm)
    if raster.has_numbers:
        write_numbers(ax, raster, np.where(wrong, cost, np.nan), image, lambda value: f"{value:.2g}")
    note = joined(f"{share:.1%} of the states have a worse action", raster.note, separator=", ")
    finish_panel(ax, raster, title, note)
    extend = "max" if (cost[wrong] > highest).any() else "neither"
    bar = color_bar([ax], raster, image, "cost of the action, V*(s) - Q*(s, a)", extend)
    name_zero(bar, lowest, highest)
    return ax


def name_zero(bar: Any, lowest: float, highest: float) -> None:
    """Writes 0 beside the lowest part of a color bar, which has the color of states without a cost.

    Args:
        bar: The color bar.
        lowest: The lower end of the bar, below 0.
        highest: The largest cost with a color of its own.
    """
    from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator

    costs = [float(cost) for cost in MaxNLocator(6).tick_values(0.0, highest) if 0.0 < cost <= highest]
    digits = [f"{cost:.10f}".rstrip("0").partition(".")[2] for cost in costs]
    decimals = max(map(len, digits), default=0)
    style = f",.{decimals}f" if FEWEST_DIGITS <= highest < MOST_DIGITS else ".4g"
    bar.locator = FixedLocator([lowest / 2, *costs])
    bar.formatter = FuncFormatter(lambda cost, _: "0" if cost < 0 else format(cost, style))
    bar.update_ticks()
    bar.outline.set(visible=True, linewidth=0.6)  # otherwise the part for 0 looks like the background


def costs(subject: Subject, best: Subject, raster: Raster) -> NDArray[np.float64]:
    """Returns (ny, nx): the cost of a subject's greedy action; 0 where it is optimal, NaN where it is not known."""
    rows = raster.rows
    if best.discretizer.shape != subject.discretizer.shape or raster.observations is not None:
        if raster.observations is None:
            raise ValueError(
                f"run must have a table of shape {best.discretizer.shape}, got {subject.discretizer.shape}"
            )
        # Observations of a Discrete space have no components.
        observations = raster.observations.reshape(-1, *best.discretizer.low.shape)
        rows = best.discretizer.active_rows(observations).reshape(*raster.rows.shape[:2], -1)
    greedy = subject.greedy_actions(raster.rows)
    optimal = best.action_values(rows)[0]
    taken = np.take_along_axis(optimal, np.maximum(greedy, 0)[..., np.newaxis], axis=-1)[..., 0]
    highest = optimal.max(axis=-1)
    cost = highest - taken
    exact = isinstance(best.source, Optimum) and best.source.exact
    of_actions = EXACT * np.maximum(np.abs(highest), np.abs(taken))
    tolerance = np.maximum(of_actions, CANCELLED * np.nanmax(np.abs(optimal), initial=0.0)) if exact else APPROXIMATE
    return np.where(greedy < 0, np.nan, np.where(cost > tolerance, cost, 0.0))


def _check_same(subject: Subject, best: Subject) -> None:
    ours, theirs = bare_id(subject.env), bare_id(best.env)
    if ours != theirs:
        raise ValueError(f"optimum must be that of {ours!r}, the run's environment, got that of {theirs!r}")
    if isinstance(best.source, Optimum) and isinstance(subject.source, Run | Runs):
        best.source.check_same_env(subject.source, with_limit=False)
    if len(subject.action_names) != len(best.action_names):
        raise ValueError(
            f"optimum must have the run's {len(subject.action_names)} actions, got {len(best.action_names)}"
        )

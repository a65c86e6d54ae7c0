"""Figure 11.3: the geometry of linear values, in the plane of the values that two weights can represent."""

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.experiment import ExactExperiment
from qtab.book.line import Line, exact_line
from qtab.book.result import Result, aligned
from qtab.book.runner import FloatArray
from qtab.envs.tabular import TabularEnv
from qtab.plots.parts.axes import axes_or_new
from qtab.plots.parts.colors import COLORS, readable
from qtab.plots.parts.labels import finish
from qtab.prediction.linear import LinearGeometry, linear_geometry

if TYPE_CHECKING:
    from matplotlib.axes import Axes

POINTS = {
    "Πv: smallest VE": "value_error",
    "smallest BE": "bellman_error",
    "TD fixed point: PBE = 0": "projected_bellman_error",
}
"""The objective that each named point minimizes."""
ANY, BACKED_UP = "v_w", "ΠBv_w"
"""Any values, and the projection of their Bellman backup."""
ANY_WEIGHTS = (-1.0, 3.0)
ERRORS = {"√VE": "value_error", "√BE": "bellman_error", "√PBE": "projected_bellman_error"}
CONTOURS = 4


@cache
def geometry() -> LinearGeometry:
    """Returns a process of three states with two features."""
    chances, rewards = [[0.1, 0.9, 0.0], [0.0, 0.3, 0.7], [0.8, 0.0, 0.2]], [2.0, -1.0, 0.0]
    rows = [
        [[(chance, state, reward, False) for state, chance in enumerate(row)]]
        for row, reward in zip(chances, rewards, strict=True)
    ]
    return linear_geometry(TabularEnv(rows, np.full(3, 1 / 3)), "random", [[1.0, 0.2], [0.6, 1.0], [0.1, 0.5]], 0.8)


def weights() -> dict[str, FloatArray]:
    """Returns the weights of each point."""
    found = geometry()
    chosen = {name: found.minimizer(objective) for name, objective in POINTS.items()}  # type: ignore[arg-type]
    any_weights = np.array(ANY_WEIGHTS)
    target = found.projection @ (found.values_of(any_weights) + found.bellman_errors(any_weights))
    backed_up = np.linalg.lstsq(found.features, target, rcond=None)[0]
    return {**chosen, ANY: any_weights, BACKED_UP: backed_up}


def coordinates(given: FloatArray) -> FloatArray:
    """Returns (..., 2): the place in the plane of the values of weights; distances are those of the norm of μ."""
    found = geometry()
    upper = np.linalg.qr(np.sqrt(found.distribution)[:, None] * found.features)[1]
    places: FloatArray = given @ upper.T
    return places


def _compute() -> list[Line]:
    return [
        exact_line(name, place[:1], place[1:]) for name, place in zip(weights(), coordinates_of_points(), strict=True)
    ]


def coordinates_of_points() -> FloatArray:
    """Returns (points, 2): the places of the points."""
    return coordinates(np.array([*weights().values()]))


def _text(lines: Sequence[Line]) -> str:
    rows = [["", "w1", "w2", *ERRORS]]
    for line, given in zip(lines, weights().values(), strict=True):
        errors = [np.sqrt(getattr(geometry(), name)(given)) for name in ERRORS.values()]
        rows.append([line.name, *(f"{value:.3f}" for value in (*given, *errors))])
    return "\n".join(aligned(rows))


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the points, and contours of each error around its minimum; returns the axes."""
    ax = axes_or_new(ax)
    places = np.array([[line.x[0], line.mean[0]] for line in result.lines])
    box = ax.get_window_extent()
    half = 0.65 * np.ptp(places, axis=0).max() * np.array([box.width / box.height, 1.0])
    center = (places.max(axis=0) + places.min(axis=0)) / 2
    axes = [np.linspace(middle - reach, middle + reach, 201) for middle, reach in zip(center, half, strict=True)]
    grid = np.stack(np.meshgrid(*axes), axis=-1)
    inverse = np.linalg.inv(coordinates(np.eye(2)))
    hues: list[Any] = [readable(hue, ax) for hue in COLORS[: len(POINTS)]]
    for hue, objective in zip(hues, POINTS.values(), strict=True):
        error = np.sqrt(getattr(geometry(), objective)(grid @ inverse))
        levels = np.linspace(error.min(), error.max(), CONTOURS + 2)[1:-1]
        ax.contour(grid[..., 0], grid[..., 1], error, levels, colors=[hue], linewidths=0.8, alpha=0.5)
    for line, place, hue in zip(result.lines, places, [*hues, "0.45", "0.45"], strict=True):
        ax.plot(*place, "o", color=hue, markersize=6)
        ax.annotate(line.name, place, (7, 5), textcoords="offset points", color=hue, fontsize=9)
    ax.annotate("", places[-1], places[-2], arrowprops={"arrowstyle": "->", "color": "0.45"})
    ax.set(xlim=axes[0][[0, -1]], ylim=axes[1][[0, -1]], aspect="equal")
    finish(ax, result.experiment.x_label, result.experiment.y_label, result.experiment.heading)
    return ax


EXPERIMENT = ExactExperiment(
    name="figure-11.3",
    title="the geometry of linear values",
    book="a drawing without numbers: three states, two weights, and the plane of the values that the weights represent",
    unspecified="the process (three states, γ = 0.8, and features with which the points are far apart). The contours "
    "are those of √VE, √BE and √PBE, and distances are in the norm of μ",
    compute=_compute,
    draw=_draw,
    names=(*POINTS, ANY, BACKED_UP),
    text=_text,
    x_label="first coordinate in the plane",
    y_label="second coordinate in the plane",
)

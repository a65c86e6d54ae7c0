"""Figure 5.1: values of the blackjack policy that sticks on 20 and 21, by Monte Carlo prediction."""

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.blackjack import blackjack
from qtab.book.drawing import title_figure
from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.result import Result
from qtab.book.runner import FloatArray
from qtab.planning.policy_values import PolicyValues
from qtab.plots.axes import shown_figure
from qtab.prediction.estimate import estimate_values
from qtab.prediction.estimates import ValueEstimates

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_POINTS = (10_000, 500_000)
_ARGUMENTS: dict[str, Any] = {
    "method": "monte_carlo",
    "first_visit": True,
    "episodes": _POINTS[-1],
    "record": _POINTS,
}
_SUMS, _CARDS = np.arange(12, 22), np.arange(1, 11)
_ACES = ("no usable ace", "usable ace")


def root_value_error(estimates: ValueEstimates, true_values: PolicyValues) -> FloatArray:
    """Returns (runs, points): the RMS error over the states, weighted by how often the policy visits them."""
    return estimates.rms_error(true_values, true_values.state_distribution)


def draw_values(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the four surfaces in a new figure, and returns the last axes.

    Raises:
        ValueError: if ``ax`` is not None.
    """
    if ax is not None:
        raise ValueError("ax must be None for figure-5.1, which creates four axes")
    figure = shown_figure(9, 7.5)
    title_figure(figure, result.experiment.heading)
    cards, sums = np.meshgrid(_CARDS, _SUMS)
    last: Any = None
    for index, (name, surface) in enumerate(result.surfaces.items()):
        last = figure.add_subplot(2, 2, index + 1, projection="3d")
        last.plot_surface(cards, sums, surface, cmap="viridis", vmin=-1, vmax=1, linewidth=0, rcount=10, ccount=10)
        last.set_title(name, fontsize="medium")
        last.set(
            xlabel="dealer shows",
            ylabel="player's sum",
            zlim=(-1, 1),
            zticks=(-1, 0, 1),
            xticks=(1, 4, 7, 10),
            yticks=(12, 15, 18, 21),
        )
        last.set_box_aspect(None, zoom=0.85)
    axes: Axes = last
    return axes


@dataclass(frozen=True, kw_only=True, repr=False)
class BlackjackValues(PredictionExperiment):
    """The surfaces of the first run, beside the errors of all."""

    def run(
        self, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
    ) -> Result:
        """Estimates the values; see :func:`qtab.book.run`."""
        result = super().run(runs, seed, threads=threads, progress=progress)
        task = blackjack()
        first = estimate_values(task.env, task.policy, seeds=[seed], **_ARGUMENTS)
        surfaces = {
            f"{_ACES[ace]}, after {count:,} episodes": first.values_after(point)[0, 12:22, 1:11, ace]
            for ace in (1, 0)
            for point, count in enumerate(_POINTS)
        }
        return dataclasses.replace(result, surfaces=surfaces, draw=draw_values)


EXPERIMENT = BlackjackValues(
    name="figure-5.1",
    title="Monte Carlo values of a blackjack policy",
    book="the policy sticks on 20 and 21; first-visit Monte Carlo; values after 10,000 and 500,000 episodes; one run",
    unspecified="",
    settings=(PredictionSetting("error against the exact values", blackjack, _ARGUMENTS, root_value_error, _POINTS),),
    runs=1,
    x_label="episodes",
    y_label="RMS error by visits",
)

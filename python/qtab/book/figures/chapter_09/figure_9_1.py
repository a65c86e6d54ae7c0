"""Figure 9.1: gradient Monte Carlo with state aggregation on the random walk of 1,000 states."""

from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.drawing import draw_lines
from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.problems import exact_values, thousand_states, values_at
from qtab.book.result import Result
from qtab.book.runner import FloatArray
from qtab.planning.policy_values import PolicyValues
from qtab.prediction.estimates import ValueEstimates
from qtab.prediction.features import state_aggregation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_STATES = tuple(float(state) for state in range(1, 1001))
_DISTRIBUTION = "state distribution μ"
_ARGUMENTS: dict[str, Any] = {
    "method": "monte_carlo",
    "learning_rate": 2e-5,
    "episodes": 100_000,
    "record": (100_000,),
    "features": state_aggregation(1000, 100),
}
_ONE = {"method": "monte_carlo", "learning_rate": 0.0, "episodes": 1}


def state_distribution(estimates: ValueEstimates, true_values: PolicyValues) -> FloatArray:
    """Returns (runs, states): the exact on-policy distribution, repeated for every run."""
    return np.broadcast_to(true_values.state_distribution, (len(estimates.seeds), 1000))


def draw_with_distribution(result: Result, ax: "Axes | None") -> "Axes":
    """Draws the values, and below them the distribution on a second axis; returns the axes of the values."""
    for line in result.lines:
        if line.name == _DISTRIBUTION:
            distribution = line
    values = tuple(line for line in result.lines if line is not distribution)
    ax = draw_lines(Result(result.experiment, values, result.runs, result.seed, result.seconds, draw_lines), ax)
    for label in list(ax.texts):  # names at the ends would cover the second axis
        label.remove()
    ax.legend(loc="upper left", frameon=False)
    other = ax.twinx()
    other.fill_between(distribution.x, 0, distribution.mean, color="0.5", alpha=0.35, linewidth=0)
    # Only the start state, with 1.4 %, is outside the figure.
    other.set(ylim=(0, 5 * np.sort(distribution.mean)[-2]), ylabel=_DISTRIBUTION)
    return ax


EXPERIMENT = PredictionExperiment(
    name="figure-9.1",
    title="state aggregation by gradient Monte Carlo",
    book="1,000 states, steps to any of 100 neighbors on a side, 10 groups of 100 states, α = 2e-5, 100,000 episodes; "
    "one run",
    unspecified="",
    settings=(
        PredictionSetting("true values", thousand_states, _ONE, exact_values, _STATES, dashed=True),
        PredictionSetting(
            "Monte Carlo values", thousand_states, _ARGUMENTS, values_at(-1), _STATES, method="Monte Carlo"
        ),
        PredictionSetting(_DISTRIBUTION, thousand_states, _ONE, state_distribution, _STATES),
    ),
    runs=1,
    x_label="state",
    y_label="value",
    table_x=(1, 50, 150, 250, 350, 450, 500, 550, 650, 750, 850, 950, 1000),
    y_range=(-1, 1),
    draw=draw_with_distribution,
)

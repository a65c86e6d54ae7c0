"""Example 6.2: TD(0) and constant-α Monte Carlo on the random walk of five states."""

from typing import TYPE_CHECKING

from qtab.book.drawing import Panel, draw_panels
from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.problems import exact_values, five_states, rms_errors, values_at
from qtab.book.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_EPISODES = 100
_STATES = tuple(float(state) for state in range(1, 6))
_SHOWN = (0, 1, 10, 100)
_START = {"initial_value": 0.5, "episodes": _EPISODES}
_RATES = {"TD": ("td", (0.05, 0.1, 0.15)), "MC": ("monte_carlo", (0.01, 0.02, 0.03, 0.04))}


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    values = {"x_label": "state", "y_label": "value", "x_ticks": _STATES, "x_tick_labels": tuple("ABCDE")}
    errors = {"x_label": "episode", "y_label": "RMS error", "y_range": (0, 0.26)}
    panels = (
        Panel("values of TD(0) with α = 0.1", [line for line in result.lines if "α" not in line.name], values),
        Panel("RMS error, averaged over the states", [line for line in result.lines if "α" in line.name], errors),
    )
    return draw_panels(result, ax, panels, shared_x=False)


EXPERIMENT = PredictionExperiment(
    name="example-6.2",
    title="TD(0) and Monte Carlo on a random walk",
    book="five states, rewards 0 and 1 at the ends, γ = 1, initial values of 0.5; values of TD(0) with α = 0.1 in one "
    "run, and errors averaged over the states and 100 runs for TD with α from 0.05 to 0.15 and Monte Carlo with α from "
    "0.01 to 0.04",
    unspecified="the order of Monte Carlo's updates within an episode (from the first step to the last here)",
    settings=(
        *(
            PredictionSetting(
                f"after {count} episode{'s' * (count != 1)}",
                five_states,
                {**_START, "learning_rate": 0.1, "record": _SHOWN},
                values_at(point),
                _STATES,
                max_runs=1,
                broad=count == 0,  # after one episode, all values but one are still the initial ones
            )
            for point, count in enumerate(_SHOWN)
        ),
        PredictionSetting(
            "true values",
            five_states,
            {**_START, "learning_rate": 0.1, "record": (0,)},
            exact_values,
            _STATES,
            max_runs=1,
            dashed=True,
        ),
        *(
            PredictionSetting(
                f"{name}, α = {rate:g}",
                five_states,
                {**_START, "method": method, "learning_rate": rate, "record": range(_EPISODES + 1)},
                rms_errors,
                tuple(range(_EPISODES + 1)),
                method="TD" if name == "TD" else "Monte Carlo",
            )
            for name, (method, rates) in _RATES.items()
            for rate in rates
        ),
    ),
    runs=100,
    x_label="state, or episode",
    y_label="value, or RMS error",
    table_x=(1, 2, 3, 4, 5, 10, 25, 50, 75, 100),
    draw=_draw,
)

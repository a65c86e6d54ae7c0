"""Figure 9.2: bootstrapping with state aggregation: the values that TD reaches, and n-step TD by n and α."""

from typing import TYPE_CHECKING

from qtab.book.drawing import Panel, draw_panels
from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.problems import ALPHAS, EPISODES, TOP, exact_values, mean_rms_error, thousand_states, values_at
from qtab.book.result import Result
from qtab.prediction.features import state_aggregation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_STATES = tuple(float(state) for state in range(1, 1001))
_LONG = 100_000
_N_STEPS = tuple(2**power for power in range(10))


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    values = {"x_label": "state", "y_label": "value", "y_range": (-1, 1)}
    errors = {"x_label": "α", "y_label": "RMS error", "y_range": (0.25, TOP)}
    panels = (
        Panel("values of semi-gradient TD(0)", [line for line in result.lines if "values" in line.name], values),
        Panel(
            "n-step TD over the first 10 episodes", [line for line in result.lines if "values" not in line.name], errors
        ),
    )
    return draw_panels(result, ax, panels, shared_x=False)


EXPERIMENT = PredictionExperiment(
    name="figure-9.2",
    title="TD with state aggregation",
    book="left: asymptotic values of semi-gradient TD(0) with 10 groups of 100 states; right: semi-gradient n-step TD "
    "with 20 groups of 50 states, errors averaged over the states, the first 10 episodes and 100 runs",
    unspecified=f"left: α and the number of episodes (2e-4 and {_LONG:,} here); right: the values of α that are drawn",
    settings=(
        PredictionSetting(
            "true values",
            thousand_states,
            {"learning_rate": 0.0, "episodes": 1},
            exact_values,
            _STATES,
            max_runs=1,
            dashed=True,
        ),
        PredictionSetting(
            "TD values",
            thousand_states,
            {
                "learning_rate": 2e-4,
                "episodes": _LONG,
                "record": (_LONG,),
                "features": state_aggregation(1000, 100),
            },
            values_at(-1),
            _STATES,
            max_runs=1,
            method="TD",
        ),
        *(
            PredictionSetting(
                f"n = {n}",
                thousand_states,
                {
                    "method": "n_step_td",
                    "n_steps": n,
                    "learning_rate": alpha,
                    "episodes": EPISODES,
                    "features": state_aggregation(1000, 50),
                },
                mean_rms_error,
                (alpha,),
            )
            for n in _N_STEPS
            for alpha in ALPHAS
        ),
    ),
    runs=100,
    x_label="state, or α",
    y_label="value, or RMS error",
    table_x=(0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 50.0, 250.0, 450.0, 550.0, 750.0, 950.0),
    draw=_draw,
)

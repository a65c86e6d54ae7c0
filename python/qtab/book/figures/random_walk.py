"""Figures 7.2, 12.3, 12.6 and 12.8: prediction by n or λ and by α on the random walk of 19 states."""

from collections.abc import Sequence

from qtab.book.drawing import draw_in_range, draw_lines
from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.problems import ALPHAS, EPISODES, TOP, mean_rms_error, nineteen_states
from qtab.book.result import Draw

N_STEPS = tuple(2**power for power in range(10))
TRACE_DECAYS = (0.0, 0.4, 0.8, 0.9, 0.95, 0.975, 0.99, 1.0)
_RATES = "the values of α that are drawn"


def _experiment(
    number: str,
    algorithm: str,
    method: str,
    parameter: tuple[str, str, Sequence[float]] = ("λ", "trace_decay", TRACE_DECAYS),
    errors: str = "errors at the ends of the first 10 episodes, averaged over the states, the episodes and 100 runs",
    unspecified: str = _RATES,
    draw: Draw = draw_in_range,
) -> PredictionExperiment:
    """Returns an experiment with a line for each value of a parameter: its symbol, its name, and its values."""
    symbol, name, values = parameter
    return PredictionExperiment(
        name=f"figure-{number}",
        title=f"{algorithm} by {symbol} and α",
        book=f"19 states, rewards -1 and 1 at the ends, γ = 1, initial values of zero; {errors}",
        unspecified=unspecified,
        settings=tuple(
            PredictionSetting(
                f"{symbol} = {value:g}",
                nineteen_states,
                {"method": method, name: value, "learning_rate": alpha, "episodes": EPISODES},
                mean_rms_error,
                (alpha,),
            )
            for value in values
            for alpha in ALPHAS
        ),
        runs=100,
        x_label="α",
        y_label="RMS error over the first 10 episodes",
        table_x=(0.1, 0.2, 0.4, 0.6, 0.8, 1.0),
        y_range=(0.25, TOP),
        draw=draw,
    )


FIGURE_7_2 = _experiment(
    "7.2",
    "n-step TD",
    "n_step_td",
    ("n", "n_steps", N_STEPS),
    "errors averaged over the states, the first 10 episodes and 100 runs",
    draw=draw_lines,
)
FIGURE_12_3 = _experiment(
    "12.3",
    "the off-line λ-return algorithm",
    "offline_lambda_return",
    unspecified=f"{_RATES}; whether the values in the λ-returns change within the off-line updates of an episode (they "
    "do not here)",
)
FIGURE_12_6 = _experiment("12.6", "TD(λ)", "td_lambda")
FIGURE_12_8 = _experiment("12.8", "true online TD(λ)", "true_online_td_lambda")

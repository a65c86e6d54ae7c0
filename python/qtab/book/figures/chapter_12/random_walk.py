"""Figures 12.3, 12.6 and 12.8: prediction with λ-returns by λ and α on the random walk of 19 states."""

from qtab.book.drawing import draw_in_range
from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.problems import ALPHAS, EPISODES, TOP, mean_rms_error, nineteen_states

TRACE_DECAYS = (0.0, 0.4, 0.8, 0.9, 0.95, 0.975, 0.99, 1.0)
_RATES = "the values of α that are drawn"


def _experiment(number: str, algorithm: str, method: str, unspecified: str = _RATES) -> PredictionExperiment:
    return PredictionExperiment(
        name=f"figure-{number}",
        title=f"{algorithm} by λ and α",
        book="19 states, rewards -1 and 1 at the ends, γ = 1, initial values of zero; errors at the ends of the first "
        "10 episodes, averaged over the states, the episodes and 100 runs",
        unspecified=unspecified,
        settings=tuple(
            PredictionSetting(
                f"λ = {trace_decay:g}",
                nineteen_states,
                {"method": method, "trace_decay": trace_decay, "learning_rate": alpha, "episodes": EPISODES},
                mean_rms_error,
                (alpha,),
            )
            for trace_decay in TRACE_DECAYS
            for alpha in ALPHAS
        ),
        runs=100,
        x_label="α",
        y_label="RMS error over the first 10 episodes",
        table_x=(0.1, 0.2, 0.4, 0.6, 0.8, 1.0),
        y_range=(0.25, TOP),
        draw=draw_in_range,
    )


FIGURE_12_3 = _experiment(
    "12.3",
    "the off-line λ-return algorithm",
    "offline_lambda_return",
    f"{_RATES}; whether the values in the λ-returns change within the off-line updates of an episode (they do not "
    "here)",
)
FIGURE_12_6 = _experiment("12.6", "TD(λ)", "td_lambda")
FIGURE_12_8 = _experiment("12.8", "true online TD(λ)", "true_online_td_lambda")

"""Figure 7.2: n-step TD by n and α on the random walk of 19 states."""

from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.problems import ALPHAS, EPISODES, TOP, mean_rms_error, nineteen_states

_N_STEPS = tuple(2**power for power in range(10))

EXPERIMENT = PredictionExperiment(
    name="figure-7.2",
    title="n-step TD by n and α",
    book="19 states, rewards -1 and 1 at the ends, γ = 1, initial values of zero; errors averaged over the states, the "
    "first 10 episodes and 100 runs",
    unspecified="the values of α that are drawn",
    settings=tuple(
        PredictionSetting(
            f"n = {n}",
            nineteen_states,
            {"method": "n_step_td", "n_steps": n, "learning_rate": alpha, "episodes": EPISODES},
            mean_rms_error,
            (alpha,),
        )
        for n in _N_STEPS
        for alpha in ALPHAS
    ),
    runs=100,
    x_label="α",
    y_label="RMS error over the first 10 episodes",
    table_x=(0.1, 0.2, 0.4, 0.6, 0.8, 1.0),
    y_range=(0.25, TOP),
)

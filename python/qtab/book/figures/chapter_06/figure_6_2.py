"""Figure 6.2: TD(0) and Monte Carlo under batch training."""

from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.problems import five_states, rms_errors

_EPISODES = 100
_METHODS = {"batch TD": ("batch_td", "TD"), "batch MC": ("monte_carlo", "Monte Carlo")}

EXPERIMENT = PredictionExperiment(
    name="figure-6.2",
    title="TD(0) and Monte Carlo under batch training",
    book="the random walk of Example 6.2; after each episode all episodes so far are presented until the values "
    "converge; errors averaged over the states and 100 runs",
    unspecified="the initial values, which unvisited states keep (0.5 here, as in Example 6.2); α (without effect on "
    "the limit)",
    settings=tuple(
        PredictionSetting(
            line,
            five_states,
            {"method": method, "initial_value": 0.5, "episodes": _EPISODES},
            rms_errors,
            tuple(range(1, _EPISODES + 1)),
            method=color,
        )
        for line, (method, color) in _METHODS.items()
    ),
    runs=100,
    x_label="episode",
    y_label="RMS error, averaged over the states",
    table_x=(1, 2, 5, 10, 25, 50, 75, 100),
    y_range=(0, 0.25),
)

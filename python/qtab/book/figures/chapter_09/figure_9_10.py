"""Figure 9.10: one tiling and fifty, on the random walk of 1,000 states."""

from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.problems import root_value_error, thousand_states
from qtab.prediction.features import tile_coding

_EPISODES, _EVERY = 5_000, 50
_POINTS = (0, 1, 10, 25, *range(_EVERY, _EPISODES + 1, _EVERY))
_FEATURES = {
    "one tiling (state aggregation)": tile_coding(1000, 200),
    "50 tilings": tile_coding(1000, 200, tilings=50, offset=4),
}

EXPERIMENT = PredictionExperiment(
    name="figure-9.10",
    title="one tiling and fifty",
    book="gradient Monte Carlo on 1,000 states; tiles of 200 states, 50 tilings offset by 4 states each; α = 1e-4 for "
    "one tiling and 1e-4/50 for fifty; 5,000 episodes, 30 runs",
    unspecified="the initial values (zero here)",
    settings=tuple(
        PredictionSetting(
            line,
            thousand_states,
            {
                "method": "monte_carlo",
                "learning_rate": 1e-4,
                "episodes": _EPISODES,
                "record": _POINTS,
                "features": features,
            },
            root_value_error,
            _POINTS,
        )
        for line, features in _FEATURES.items()
    ),
    runs=30,
    x_label="episode",
    y_label="root of the value error VE",
    table_x=(0, 50, 500, 1000, 2000, 3000, 4000, 5000),
    y_range=(0, 0.6),
)

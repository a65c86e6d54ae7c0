"""Figure 10.2: learning curves of semi-gradient Sarsa on Mountain Car."""

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.problems import ENV, TILE_CODING, UNSPECIFIED
from qtab.book.setting import Setting, lengths

EXPERIMENT = TrainingExperiment(
    name="figure-10.2",
    title="semi-gradient Sarsa on Mountain Car",
    book="8 tilings, ε = 0, α of 0.1/8, 0.2/8 and 0.5/8; 500 episodes, 100 runs",
    unspecified=UNSPECIFIED,
    settings=tuple(
        Setting(
            f"α = {alpha}/8",
            ENV,
            {**TILE_CODING, "algorithm": "sarsa", "learning_rate": alpha, "episodes": 500},
            lengths,
        )
        for alpha in (0.1, 0.2, 0.5)
    ),
    runs=100,
    x_label="episode",
    y_label="steps per episode",
    table_x=(1, 2, 5, 10, 20, 50, 100, 200, 300, 400, 500),
    log_y=True,
    y_range=(100, 1000),
)

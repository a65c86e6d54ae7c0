"""Figure 10.3: one-step and eight-step semi-gradient Sarsa on Mountain Car."""

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.problems import ENV, TILE_CODING, UNSPECIFIED
from qtab.book.setting import Setting, lengths

EXPERIMENT = TrainingExperiment(
    name="figure-10.3",
    title="one-step and eight-step Sarsa on Mountain Car",
    book="n = 1 with α = 0.5/8, n = 8 with α = 0.3/8; 500 episodes, 100 runs",
    unspecified=UNSPECIFIED,
    settings=tuple(
        Setting(
            f"n = {n}",
            ENV,
            {**TILE_CODING, "algorithm": "n_step_sarsa", "n_steps": n, "learning_rate": alpha, "episodes": 500},
            lengths,
        )
        for n, alpha in ((1, 0.5), (8, 0.3))
    ),
    runs=100,
    x_label="episode",
    y_label="steps per episode",
    table_x=(1, 2, 5, 10, 20, 50, 100, 200, 300, 400, 500),
    max_episode_steps=20_000,
    log_y=True,
    y_range=(100, 1000),
)

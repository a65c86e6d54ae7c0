"""Figure 10.4: n-step semi-gradient Sarsa on Mountain Car, early performance by n and α."""

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.problems import ENV, TILE_CODING, UNSPECIFIED
from qtab.book.setting import Setting, mean_length

ALPHAS = (0.1, 0.14, 0.2, 0.28, 0.4, 0.57, 0.8, 1.13, 1.6)
"""Evenly spaced on a log scale, as in the book."""
STEPS = (1, 2, 4, 8, 16)


def n_step_settings() -> tuple[Setting, ...]:
    """Returns one setting for each n and α."""
    return tuple(
        Setting(
            f"n = {n}",
            ENV,
            {**TILE_CODING, "algorithm": "n_step_sarsa", "n_steps": n, "learning_rate": alpha, "episodes": 50},
            mean_length,
            x=(alpha,),
        )
        for n in STEPS
        for alpha in ALPHAS
    )


EXPERIMENT = TrainingExperiment(
    name="figure-10.4",
    title="n-step semi-gradient Sarsa on Mountain Car, by n and α",
    book="n of 1, 2, 4, 8 and 16; the first 50 episodes, 100 runs",
    unspecified=f"the values of α (nine here, evenly spaced on a log scale); {UNSPECIFIED}",
    settings=n_step_settings(),
    runs=100,
    x_label="α × number of tilings (8)",
    y_label="steps per episode",
    max_episode_steps=20_000,
    log_x=True,
    x_ticks=ALPHAS,
    y_range=(215, 300),
)

"""Figure 13.2: REINFORCE with and without a baseline."""

from qtab.book.figures.chapter_13.short_corridor import (
    BEST_RETURN,
    BOOK_RUNS,
    ENV,
    MAX_EPISODE_STEPS,
    RUNS,
    UNSPECIFIED,
    reinforce,
)
from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.setting import Setting, returns

_BASELINE = {"algorithm": "reinforce_with_baseline", "value_learning_rate": 2.0**-6}

EXPERIMENT = TrainingExperiment(
    name="figure-13.2",
    title="REINFORCE with and without a baseline",
    book=f"REINFORCE with α = 2⁻¹³; with baseline α = 2⁻⁹ for the policy and 2⁻⁶ for the state values; {BOOK_RUNS}",
    unspecified=UNSPECIFIED,
    settings=(
        Setting("REINFORCE with baseline", ENV, reinforce(-9, **_BASELINE), returns),
        Setting("REINFORCE", ENV, reinforce(-13), returns),
    ),
    runs=RUNS,
    max_episode_steps=MAX_EPISODE_STEPS,
    x_label="episode",
    y_label="total reward on episode",
    table_x=(1, 100, 200, 400, 600, 800, 1000),
    y_range=(-90, -10),
    y_marks={"v*(s0)": BEST_RETURN},
)

"""Figure 13.1: REINFORCE on the short corridor."""

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

EXPERIMENT = TrainingExperiment(
    name="figure-13.1",
    title="REINFORCE on the short corridor",
    book=f"α = 2⁻¹², 2⁻¹³ and 2⁻¹⁴; {BOOK_RUNS}",
    unspecified=UNSPECIFIED,
    settings=tuple(
        Setting(f"α = {text}", ENV, reinforce(log_alpha), returns)
        for log_alpha, text in ((-12, "2⁻¹²"), (-13, "2⁻¹³"), (-14, "2⁻¹⁴"))
    ),
    runs=RUNS,
    max_episode_steps=MAX_EPISODE_STEPS,
    x_label="episode",
    y_label="total reward on episode",
    table_x=(1, 100, 200, 400, 600, 800, 1000),
    y_range=(-90, -10),
    y_marks={"v*(s0)": BEST_RETURN},
)

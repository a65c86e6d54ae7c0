"""Figure 8.4: Dyna-Q and Dyna-Q+ on the blocking maze."""

from qtab.book.figures.chapter_08.changing_mazes import UNSPECIFIED, settings
from qtab.book.measured_experiment import TrainingExperiment

STEPS = 3_000
SHORTEST = 10
"""The number of steps of the shortest path before the change."""

EXPERIMENT = TrainingExperiment(
    name="figure-8.4",
    title="Dyna agents on a blocking task",
    book="the path along the right side is blocked after 1,000 time steps, and a longer one along the left side opens; "
    "3,000 time steps",
    unspecified=UNSPECIFIED,
    settings=settings("qtab/BlockingMaze-v0", STEPS, STEPS // SHORTEST),
    runs=100,
    max_episode_steps=STEPS,
    x_label="time steps",
    y_label="cumulative reward",
    table_x=(500, 1000, 1500, 2000, 2500, 3000),
    x_range=(0, STEPS),
    y_range=(0, 160),
)

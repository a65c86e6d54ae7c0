"""Figure 8.5: Dyna-Q and Dyna-Q+ on the shortcut maze."""

from qtab.book.figures.chapter_08.changing_mazes import UNSPECIFIED, settings
from qtab.book.measured_experiment import TrainingExperiment

STEPS = 6_000
SHORTEST = 10
"""The number of steps of the shortest path after the change."""

EXPERIMENT = TrainingExperiment(
    name="figure-8.5",
    title="Dyna agents on a shortcut task",
    book="a shorter path along the right side opens after 3,000 time steps; 6,000 time steps",
    unspecified=UNSPECIFIED,
    settings=settings("qtab/ShortcutMaze-v0", STEPS, STEPS // SHORTEST),
    runs=100,
    max_episode_steps=STEPS,
    x_label="time steps",
    y_label="cumulative reward",
    table_x=(1000, 2000, 3000, 4000, 5000, 6000),
    x_range=(0, STEPS),
    y_range=(0, 400),
)

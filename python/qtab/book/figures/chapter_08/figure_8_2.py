"""Figure 8.2: Dyna-Q on a maze."""

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.setting import Setting, lengths
from qtab.config.preset_settings import DYNA_MAZE
from qtab.envs.grid_worlds import dyna_maze

EXPERIMENT = TrainingExperiment(
    name="figure-8.2",
    title="Dyna-Q with different numbers of planning steps",
    book="α = 0.1, ε = 0.1, γ = 0.95, initial values of zero, ties at random; 50 episodes, 30 runs",
    unspecified="nothing. In the book the first episode is the same for every n (about 1,700 steps, not shown). Here "
    "it differs, because planning and acting draw from the same random generator",
    settings=tuple(
        Setting(f"n = {steps}", dyna_maze, {**DYNA_MAZE, "planning_steps": steps}, lengths) for steps in (0, 5, 50)
    ),
    runs=30,
    x_label="episode",
    y_label="steps per episode",
    table_x=(1, 2, 3, 5, 10, 20, 30, 50),
    x_range=(2, 50),
    y_range=(0, 800),
)

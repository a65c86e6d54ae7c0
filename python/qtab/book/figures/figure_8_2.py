"""Figure 8.2: Dyna-Q on a maze."""

from qtab.book.experiment import Experiment, Setting
from qtab.book.measures import lengths
from qtab.envs.grid_worlds import dyna_maze

_DYNA = {
    "algorithm": "dyna_q",
    "learning_rate": 0.1,
    "discount": 0.95,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    "episodes": 50,
}

EXPERIMENT = Experiment(
    name="figure-8.2",
    title="Dyna-Q with different numbers of planning steps",
    book="α = 0.1, ε = 0.1, γ = 0.95, values of zero, ties at random; 50 episodes, 30 runs",
    silent="nothing. There the first episode is the same for every n (about 1,700 steps, not shown); here planning "
    "draws from the same stream as acting, so that it differs",
    settings=tuple(
        Setting(f"n = {steps}", dyna_maze, {**_DYNA, "planning_steps": steps}, lengths) for steps in (0, 5, 50)
    ),
    runs=30,
    x="episode",
    y="steps per episode",
    shown=(1, 2, 3, 5, 10, 20, 30, 50),
    x_range=(2, 50),
    y_range=(0, 800),
)

"""Figures 8.4 and 8.5: Dyna-Q and Dyna-Q+ on the blocking maze and the shortcut maze."""

from typing import Any

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.setting import Setting, reward_by
from qtab.config.preset_settings import CHANGING_MAZE

SHORTEST = 10
"""The number of steps of the shortest path, before the change or after it."""
_DYNA: dict[str, Any] = {
    name: value for name, value in CHANGING_MAZE.items() if name not in ("algorithm", "time_weight", "episodes")
}
_PLUS = {"algorithm": "dyna_q_plus", "time_weight": CHANGING_MAZE["time_weight"]}


def _experiment(number: str, task: str, book: str, env: str, steps: int, most: int) -> TrainingExperiment:
    """Returns the experiment whose lines are the cumulative rewards every 50 time steps, up to ``most``."""
    times = tuple(range(50, steps + 1, 50))
    measure, x = reward_by(times), tuple(map(float, times))
    base = {**_DYNA, "episodes": steps // SHORTEST}
    return TrainingExperiment(
        name=f"figure-{number}",
        title=f"Dyna agents on a {task} task",
        book=f"{book}; {steps:,} time steps",
        unspecified=f"all settings but the mazes. Here α = {_DYNA['learning_rate']:g}, ε = 0.1, γ = 0.95, "
        f"n = {_DYNA['planning_steps']}, κ = {CHANGING_MAZE['time_weight']:g}, ties are broken at random, and the "
        "number of runs is 100",
        settings=(
            Setting("Dyna-Q+", env, {**base, **_PLUS}, measure, x, method="dyna_q_plus"),
            Setting("Dyna-Q", env, {**base, "algorithm": "dyna_q"}, measure, x, method="dyna_q"),
        ),
        runs=100,
        max_episode_steps=steps,
        x_label="time steps",
        y_label="cumulative reward",
        table_x=tuple(part * steps // 6 for part in range(1, 7)),
        x_range=(0, steps),
        y_range=(0, most),
    )


FIGURE_8_4 = _experiment(
    "8.4",
    "blocking",
    "the path along the right side is blocked after 1,000 time steps, and a longer one along the left side opens",
    "qtab/BlockingMaze-v0",
    3_000,
    160,
)
FIGURE_8_5 = _experiment(
    "8.5",
    "shortcut",
    "a shorter path along the right side opens after 3,000 time steps",
    "qtab/ShortcutMaze-v0",
    6_000,
    400,
)

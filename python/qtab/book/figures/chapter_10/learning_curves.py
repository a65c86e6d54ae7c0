"""Figures 10.2 and 10.3: learning curves of one-step and n-step semi-gradient Sarsa on Mountain Car."""

from typing import Any

from qtab.book.measured_experiment import MAX_EPISODE_STEPS, TrainingExperiment
from qtab.book.problems import ENV, TILE_CODING, UNSPECIFIED
from qtab.book.setting import Setting, lengths


def _experiment(
    number: str, title: str, book: str, lines: dict[str, dict[str, Any]], max_episode_steps: int = MAX_EPISODE_STEPS
) -> TrainingExperiment:
    """Returns an experiment; ``lines`` has the settings that differ, by the names of the lines."""
    return TrainingExperiment(
        name=f"figure-{number}",
        title=f"{title} on Mountain Car",
        book=f"{book}; 500 episodes, 100 runs",
        unspecified=UNSPECIFIED,
        settings=tuple(
            Setting(name, ENV, {**TILE_CODING, **config, "episodes": 500}, lengths) for name, config in lines.items()
        ),
        runs=100,
        x_label="episode",
        y_label="steps per episode",
        table_x=(1, 2, 5, 10, 20, 50, 100, 200, 300, 400, 500),
        max_episode_steps=max_episode_steps,
        log_y=True,
        y_range=(100, 1000),
    )


FIGURE_10_2 = _experiment(
    "10.2",
    "semi-gradient Sarsa",
    "8 tilings, ε = 0, α of 0.1/8, 0.2/8 and 0.5/8",
    {f"α = {alpha}/8": {"algorithm": "sarsa", "learning_rate": alpha} for alpha in (0.1, 0.2, 0.5)},
)
FIGURE_10_3 = _experiment(
    "10.3",
    "one-step and eight-step Sarsa",
    "n = 1 with α = 0.5/8, n = 8 with α = 0.3/8",
    {
        f"n = {n}": {"algorithm": "n_step_sarsa", "n_steps": n, "learning_rate": alpha}
        for n, alpha in ((1, 0.5), (8, 0.3))
    },
    max_episode_steps=20_000,
)

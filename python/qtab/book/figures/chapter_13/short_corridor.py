"""Example 13.1 and Figures 13.1 and 13.2: the short corridor with switched actions, and REINFORCE on it."""

import math
from typing import Any

import numpy as np

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.setting import Setting, mean_return, returns

ENV = "qtab/ShortCorridor-v0"
BEST_RETURN = -6.0 - 4.0 * math.sqrt(2.0)
"""The return of the best policy, which goes right with probability 2 - √2."""

EXAMPLE_13_1 = TrainingExperiment(
    name="example-13.1",
    title="the short corridor by the probability of going right",
    book="the expected return from the first state. It is about -82 and -44 where left or right is taken with "
    "probability 0.95, and -11.6 at best, with a probability of about 0.59",
    unspecified="nothing: the book computes the values, here they are the returns of 1,000 episodes without learning",
    settings=tuple(
        Setting(
            "softmax policy",
            ENV,
            {
                "algorithm": "reinforce",
                "learning_rate": 0.0,
                "initial_q": np.array([[0.0, math.log(probability / (1.0 - probability))]]),
                "episodes": 1000,
            },
            mean_return,
            (probability,),
            method="REINFORCE",
        )
        for probability in np.round(np.arange(0.05, 0.951, 0.05), 2).tolist()
    ),
    runs=100,
    x_label="probability of going right",
    y_label="return",
    x_range=(0, 1),
    y_range=(-100, 0),
    y_marks={"the best policy: -6 - 4√2": BEST_RETURN},
)


def _learning(number: str, title: str, book: str, lines: dict[str, dict[str, Any]]) -> TrainingExperiment:
    """Returns an experiment on learning; ``lines`` has the settings that differ, by the names of the lines."""
    return TrainingExperiment(
        name=f"figure-{number}",
        title=title,
        book=f"{book}; 100 runs of 1,000 episodes (1,000 runs here, as a few stuck runs dominate the mean of 100)",
        unspecified="the initial policy (right with probability 0.05 here, as the returns of the book's first episodes "
        "show)",
        settings=tuple(
            Setting(name, ENV, {"preset": "book", "episodes": 1000, **config}, returns)
            for name, config in lines.items()
        ),
        runs=1_000,
        max_episode_steps=1_000,  # a policy that has become almost deterministic would hardly ever end an episode
        x_label="episode",
        y_label="total reward on episode",
        table_x=(1, 100, 200, 400, 600, 800, 1000),
        y_range=(-90, -10),
        y_marks={"v*(s0)": BEST_RETURN},
    )


FIGURE_13_1 = _learning(
    "13.1",
    "REINFORCE on the short corridor",
    "α = 2⁻¹², 2⁻¹³ and 2⁻¹⁴",
    {f"α = {text}": {"learning_rate": 2.0**power} for power, text in ((-12, "2⁻¹²"), (-13, "2⁻¹³"), (-14, "2⁻¹⁴"))},
)
FIGURE_13_2 = _learning(
    "13.2",
    "REINFORCE with and without a baseline",
    "REINFORCE with α = 2⁻¹³; with baseline α = 2⁻⁹ for the policy and 2⁻⁶ for the state values",
    {
        "REINFORCE with baseline": {
            "algorithm": "reinforce_with_baseline",
            "learning_rate": 2.0**-9,
            "value_learning_rate": 2.0**-6,
        },
        "REINFORCE": {"learning_rate": 2.0**-13},
    },
)

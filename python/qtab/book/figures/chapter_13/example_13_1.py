"""Example 13.1: the short corridor with switched actions, by the probability of going right."""

import math

import numpy as np

from qtab.book.figures.chapter_13.short_corridor import BEST_RETURN, ENV
from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.setting import Setting, mean_return

_PROBABILITIES = tuple(np.round(np.arange(0.05, 0.951, 0.05), 2).tolist())

EXPERIMENT = TrainingExperiment(
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
        for probability in _PROBABILITIES
    ),
    runs=100,
    x_label="probability of going right",
    y_label="return",
    x_range=(0, 1),
    y_range=(-100, 0),
    y_marks={"the best policy: -6 - 4√2": BEST_RETURN},
)

"""Figure 6.5: maximization bias."""

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.runner import EpisodeLog, FloatArray
from qtab.book.setting import Setting

FINAL = 20
"""The number of last episodes whose mean is the final value in the table."""
OPTIMAL = 5.0
"""The percentage of left actions of an ε-greedy policy that knows the true values."""
_BOOK = {"preset": "book", "learning_rate": 0.1, "discount": 1.0, "epsilon": 0.1, "ties": "random", "episodes": 300}


def left(log: EpisodeLog) -> FloatArray:
    """Returns (runs, episodes): 100 for an episode that went left, which takes two steps, else 0."""
    percentages: FloatArray = 100.0 * (log.lengths == 2)
    return percentages


def final_left(log: EpisodeLog) -> FloatArray:
    """Returns (runs, 1): the percentage of the last 20 episodes that went left."""
    percentages: FloatArray = left(log)[:, -FINAL:].mean(axis=1, keepdims=True)
    return percentages


EXPERIMENT = TrainingExperiment(
    name="figure-6.5",
    title="maximization bias",
    book="ε = 0.1, α = 0.1, γ = 1, initial values of zero, rewards of mean -0.1 and variance 1, ties at random; 10,000 "
    "runs of 300 episodes",
    unspecified='the number of actions in B ("many"; 10 here). The greedy action in the target of Double Q-learning is '
    "the first of several here, not a random one",
    settings=tuple(
        Setting(
            name + suffix,
            "qtab/MaximizationBias-v0",
            {**_BOOK, "algorithm": algorithm},
            measure,
            x,
            drawn=not suffix,
        )
        for suffix, measure, x in (("", left, None), (f", last {FINAL} episodes", final_left, (300.0,)))
        for name, algorithm in (("Q-learning", "q_learning"), ("Double Q-learning", "double_q_learning"))
    ),
    runs=10_000,
    x_label="episode",
    y_label="left actions from A, %",
    table_x=(1, 5, 10, 20, 30, 50, 100, 150, 200, 250, 300),
    y_range=(0, 100),
    y_marks={"optimal": OPTIMAL},
)

"""Figure 6.5: maximisation bias."""

from qtab.book.experiment import Experiment, Numbers, Setting
from qtab.book.trials import Outcome

_BOOK = {"preset": "book", "learning_rate": 0.1, "discount": 1.0, "epsilon": 0.1, "ties": "random", "episodes": 300}


def left(outcome: Outcome) -> Numbers:
    """Returns, in per cent, whether an episode went left: it then took two steps."""
    share: Numbers = 100.0 * (outcome.lengths == 2)
    return share


EXPERIMENT = Experiment(
    name="figure-6.5",
    title="maximisation bias",
    book="ε = 0.1, α = 0.1, γ = 1, values of zero, rewards of mean -0.1 and variance 1, ties at random; 10,000 runs of "
    "300 episodes",
    silent='how many actions B has ("many"; 10 here)',
    settings=tuple(
        Setting(name, "qtab/MaximizationBias-v0", {**_BOOK, "algorithm": algorithm}, left)
        for name, algorithm in (("Q-learning", "q_learning"), ("Double Q-learning", "double_q_learning"))
    ),
    runs=10_000,
    x="episode",
    y="left actions from A, %",
    shown=(1, 5, 10, 20, 30, 50, 100, 150, 200, 250, 300),
    y_range=(0, 100),
)

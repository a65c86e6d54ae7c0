"""Figure 6.3: interim and asymptotic performance on the cliff, as a function of α."""

from qtab.book.experiment import Experiment, Setting
from qtab.book.measures import mean_return

ALPHAS = tuple(round(0.1 * tenth, 1) for tenth in range(1, 11))
_ALGORITHMS = {"Sarsa": "sarsa", "Q-learning": "q_learning", "Expected Sarsa": "expected_sarsa"}
_COMMON = {"discount": 1.0, "epsilon": 0.1, "epsilon_schedule": "constant", "ties": "random", "initial_q": 0.0}

EXPERIMENT = Experiment(
    name="figure-6.3",
    title="interim and asymptotic performance on the cliff",
    book="ε = 0.1; interim: the first 100 episodes, 50,000 runs; asymptotic: 100,000 episodes, 10 runs (after van "
    "Seijen et al., 2009)",
    silent="values of zero and ties (at random here); 10 values of α here",
    settings=tuple(
        Setting(
            f"{name}, {kind}",
            "CliffWalking-v1",
            {**_COMMON, "algorithm": algorithm, "learning_rate": alpha, "episodes": episodes},
            mean_return,
            x=(alpha,),
            most_runs=most_runs,
        )
        for kind, episodes, most_runs in (("interim", 100, None), ("asymptotic", 100_000, 10))
        for name, algorithm in _ALGORITHMS.items()
        for alpha in ALPHAS
    ),
    runs=50_000,
    x="α",
    y="sum of rewards an episode",
    y_range=(-160, 0),
)

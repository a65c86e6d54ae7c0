"""Figure 6.3: interim and asymptotic performance on the cliff, as a function of α."""

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.setting import Setting, mean_return

ALPHAS = tuple(round(0.1 * tenth, 1) for tenth in range(1, 11))
_ALGORITHMS = {"Sarsa": "sarsa", "Q-learning": "q_learning", "Expected Sarsa": "expected_sarsa"}
_COMMON = {"discount": 1.0, "epsilon": 0.1, "epsilon_schedule": "constant", "ties": "random", "initial_q": 0.0}

EXPERIMENT = TrainingExperiment(
    name="figure-6.3",
    title="interim and asymptotic performance on the cliff",
    book="ε = 0.1; interim: the first 100 episodes, 50,000 runs; asymptotic: 100,000 episodes, 10 runs (after van "
    "Seijen et al., 2009)",
    unspecified="the initial values (zero here), how ties are broken (at random here), and the values of α (10 here)",
    settings=tuple(
        Setting(
            f"{name}, {kind}",
            "CliffWalking-v1",
            {**_COMMON, "algorithm": algorithm, "learning_rate": alpha, "episodes": episodes},
            mean_return,
            x=(alpha,),
            max_runs=max_runs,
            method=name,
            dashed=kind == "interim",
        )
        for kind, episodes, max_runs in (("interim", 100, None), ("asymptotic", 100_000, 10))
        for name, algorithm in _ALGORITHMS.items()
        for alpha in ALPHAS
    ),
    runs=50_000,
    x_label="α",
    y_label="sum of rewards per episode",
    x_ticks=ALPHAS,
    y_range=(-160, 0),
)

"""Example 6.6 and Figure 6.3: Sarsa, Q-learning and Expected Sarsa on the cliff."""

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.setting import Setting, final_return, mean_return, returns

ENV = "CliffWalking-v1"
_ALGORITHMS = {"Sarsa": "sarsa", "Q-learning": "q_learning"}
_COMMON = {"discount": 1.0, "epsilon": 0.1, "epsilon_schedule": "constant", "ties": "random", "initial_q": 0.0}

EXAMPLE_6_6 = TrainingExperiment(
    name="example-6.6",
    title="Sarsa and Q-learning on the cliff",
    book="ε = 0.1, γ = 1, 500 episodes",
    unspecified="α (0.5 here), the initial values (zero here), how ties are broken (at random here), and the number of "
    "runs behind the smoothed curves (500 here)",
    settings=tuple(
        Setting(
            name + suffix,
            ENV,
            {**_COMMON, "learning_rate": 0.5, "episodes": 500, "algorithm": algorithm},
            measure,
            x,
            drawn=not suffix,
        )
        for suffix, measure, x in (("", returns, None), (", mean of the last 100", final_return, (500,)))
        for name, algorithm in _ALGORITHMS.items()
    ),
    runs=500,
    x_label="episode",
    y_label="sum of rewards during the episode",
    table_x=(1, 10, 25, 50, 100, 200, 300, 400, 500),
    y_range=(-100, -10),
)

_ALPHAS = tuple(round(0.1 * tenth, 1) for tenth in range(1, 11))
FIGURE_6_3 = TrainingExperiment(
    name="figure-6.3",
    title="interim and asymptotic performance on the cliff",
    book="ε = 0.1; interim: the first 100 episodes, 50,000 runs; asymptotic: 100,000 episodes, 10 runs (after van "
    "Seijen et al., 2009)",
    unspecified="the initial values (zero here), how ties are broken (at random here), and the values of α (10 here)",
    settings=tuple(
        Setting(
            f"{name}, {kind}",
            ENV,
            {**_COMMON, "algorithm": algorithm, "learning_rate": alpha, "episodes": episodes},
            mean_return,
            (alpha,),
            max_runs=max_runs,
            method=name,
            dashed=kind == "interim",
        )
        for kind, episodes, max_runs in (("interim", 100, None), ("asymptotic", 100_000, 10))
        for name, algorithm in {**_ALGORITHMS, "Expected Sarsa": "expected_sarsa"}.items()
        for alpha in _ALPHAS
    ),
    runs=50_000,
    x_label="α",
    y_label="sum of rewards per episode",
    x_ticks=_ALPHAS,
    y_range=(-160, 0),
)

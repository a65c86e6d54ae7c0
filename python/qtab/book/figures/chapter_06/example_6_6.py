"""Example 6.6: Sarsa and Q-learning on the cliff."""

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.setting import Setting, final_return, returns

_ALGORITHMS = {"Sarsa": "sarsa", "Q-learning": "q_learning"}
_EPISODES = 500
_COMMON = {
    "learning_rate": 0.5,
    "discount": 1.0,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    "episodes": _EPISODES,
}

EXPERIMENT = TrainingExperiment(
    name="example-6.6",
    title="Sarsa and Q-learning on the cliff",
    book="ε = 0.1, γ = 1, 500 episodes",
    unspecified="α (0.5 here), the initial values (zero here), how ties are broken (at random here), and the number of "
    "runs behind the smoothed curves (500 here)",
    settings=(
        *(
            Setting(name, "CliffWalking-v1", {**_COMMON, "algorithm": algorithm}, returns)
            for name, algorithm in _ALGORITHMS.items()
        ),
        *(
            Setting(
                f"{name}, mean of the last 100",
                "CliffWalking-v1",
                {**_COMMON, "algorithm": algorithm},
                final_return,
                x=(_EPISODES,),
                drawn=False,
            )
            for name, algorithm in _ALGORITHMS.items()
        ),
    ),
    runs=500,
    x_label="episode",
    y_label="sum of rewards during the episode",
    table_x=(1, 10, 25, 50, 100, 200, 300, 400, 500),
    y_range=(-100, -10),
)

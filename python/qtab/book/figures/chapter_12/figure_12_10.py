"""Figure 12.10: Sarsa(λ) with replacing traces on Mountain Car, early performance by λ and α."""

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.problems import ENV, TILE_CODING, UNSPECIFIED
from qtab.book.setting import Setting, mean_length

ALPHAS = (0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6)
TRACE_DECAYS = (0.0, 0.68, 0.84, 0.92, 0.96, 0.98, 0.99)

EXPERIMENT = TrainingExperiment(
    name="figure-12.10",
    title="Sarsa(λ) with replacing traces on Mountain Car, by λ and α",
    book="λ of 0, 0.68, 0.84, 0.92, 0.96, 0.98 and 0.99; the first 50 episodes, 100 runs. The book "
    "shows Figure 10.4 beside it",
    unspecified=f"the values of α (ten here); {UNSPECIFIED}",
    settings=tuple(
        Setting(
            f"λ = {trace_decay:g}",
            ENV,
            {
                **TILE_CODING,
                "algorithm": "sarsa_lambda",
                "traces": "replacing",
                "trace_decay": trace_decay,
                "learning_rate": alpha,
                "episodes": 50,
            },
            mean_length,
            x=(alpha,),
        )
        for trace_decay in TRACE_DECAYS
        for alpha in ALPHAS
    ),
    runs=100,
    x_label="α × number of tilings (8)",
    y_label="steps per episode",
    y_range=(170, 300),
)

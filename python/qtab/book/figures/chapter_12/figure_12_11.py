"""Figure 12.11: Sarsa(λ) with four kinds of traces on Mountain Car."""

from typing import Any

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.problems import ENV, TILE_CODING, UNSPECIFIED
from qtab.book.setting import Setting, mean_return

ALPHAS = tuple(round(0.2 * fifth, 1) for fifth in range(1, 11))
KINDS: dict[str, dict[str, Any]] = {
    "true online Sarsa(λ)": {"algorithm": "true_online_sarsa_lambda"},
    "replacing, clearing": {"algorithm": "sarsa_lambda", "traces": "clearing"},
    "replacing": {"algorithm": "sarsa_lambda", "traces": "replacing"},
    "accumulating": {"algorithm": "sarsa_lambda", "traces": "accumulating"},
}

EXPERIMENT = TrainingExperiment(
    name="figure-12.11",
    title="Sarsa(λ) with four kinds of traces on Mountain Car",
    book="true online Sarsa(λ), and Sarsa(λ) with replacing traces, with replacing traces that clear the traces of "
    "the other actions, and with accumulating traces; the first 20 episodes, 100 runs",
    unspecified=f"λ (0.9 here); {UNSPECIFIED}",
    settings=tuple(
        Setting(
            name,
            ENV,
            {**TILE_CODING, **kind, "trace_decay": 0.9, "learning_rate": alpha, "episodes": 20},
            mean_return,
            x=(alpha,),
        )
        for name, kind in KINDS.items()
        for alpha in ALPHAS
    ),
    runs=100,
    x_label="α × number of tilings (8)",
    y_label="reward per episode",
    x_ticks=ALPHAS,
    y_range=(-550, -150),
)

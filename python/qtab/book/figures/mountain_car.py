"""Figures 10.2 to 10.4, 12.10 and 12.11: Sarsa, n-step Sarsa and Sarsa(λ) on Mountain Car."""

from collections.abc import Mapping, Sequence
from typing import Any

from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.problems import ENV, TILE_CODING, UNSPECIFIED
from qtab.book.setting import Measure, Setting, lengths, mean_length, mean_return

Lines = Mapping[str, Mapping[str, Any]]
"""The settings in which the lines differ, by the names of the lines."""


def _by_episode(lines: Lines, **fields: Any) -> TrainingExperiment:
    """Returns an experiment whose lines are learning curves of 500 episodes."""
    return TrainingExperiment(
        **fields,
        unspecified=UNSPECIFIED,
        settings=tuple(
            Setting(name, ENV, {**TILE_CODING, **config, "episodes": 500}, lengths) for name, config in lines.items()
        ),
        runs=100,
        x_label="episode",
        y_label="steps per episode",
        table_x=(1, 2, 5, 10, 20, 50, 100, 200, 300, 400, 500),
        log_y=True,
        y_range=(100, 1000),
    )


def _by_rate(
    lines: Lines, rates: Sequence[float], episodes: int, measure: Measure, unspecified: str, **fields: Any
) -> TrainingExperiment:
    """Returns an experiment whose lines have a point for each learning rate: the first episodes of all runs."""
    return TrainingExperiment(
        **fields,
        unspecified=f"{unspecified}; {UNSPECIFIED}",
        settings=tuple(
            Setting(name, ENV, {**TILE_CODING, **config, "learning_rate": rate, "episodes": episodes}, measure, (rate,))
            for name, config in lines.items()
            for rate in rates
        ),
        runs=100,
        x_label="α × number of tilings (8)",
    )


FIGURE_10_2 = _by_episode(
    {f"α = {alpha}/8": {"algorithm": "sarsa", "learning_rate": alpha} for alpha in (0.1, 0.2, 0.5)},
    name="figure-10.2",
    title="semi-gradient Sarsa on Mountain Car",
    book="8 tilings, ε = 0, α of 0.1/8, 0.2/8 and 0.5/8; 500 episodes, 100 runs",
)
FIGURE_10_3 = _by_episode(
    {
        f"n = {n}": {"algorithm": "n_step_sarsa", "n_steps": n, "learning_rate": alpha}
        for n, alpha in ((1, 0.5), (8, 0.3))
    },
    name="figure-10.3",
    title="one-step and eight-step Sarsa on Mountain Car",
    book="n = 1 with α = 0.5/8, n = 8 with α = 0.3/8; 500 episodes, 100 runs",
    max_episode_steps=20_000,
)
_LOG_RATES = (0.1, 0.14, 0.2, 0.28, 0.4, 0.57, 0.8, 1.13, 1.6)
"""Evenly spaced on a log scale, as in the book."""
FIGURE_10_4 = _by_rate(
    {f"n = {n}": {"algorithm": "n_step_sarsa", "n_steps": n} for n in (1, 2, 4, 8, 16)},
    _LOG_RATES,
    50,
    mean_length,
    "the values of α (nine here, evenly spaced on a log scale)",
    name="figure-10.4",
    title="n-step semi-gradient Sarsa on Mountain Car, by n and α",
    book="n of 1, 2, 4, 8 and 16; the first 50 episodes, 100 runs",
    y_label="steps per episode",
    max_episode_steps=20_000,
    log_x=True,
    x_ticks=_LOG_RATES,
    y_range=(215, 300),
)
FIGURE_12_10 = _by_rate(
    {
        f"λ = {trace_decay:g}": {"algorithm": "sarsa_lambda", "traces": "replacing", "trace_decay": trace_decay}
        for trace_decay in (0.0, 0.68, 0.84, 0.92, 0.96, 0.98, 0.99)
    },
    (0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6),
    50,
    mean_length,
    "the values of α (ten here)",
    name="figure-12.10",
    title="Sarsa(λ) with replacing traces on Mountain Car, by λ and α",
    book="λ of 0, 0.68, 0.84, 0.92, 0.96, 0.98 and 0.99; the first 50 episodes, 100 runs. The book "
    "shows Figure 10.4 beside it",
    y_label="steps per episode",
    y_range=(170, 300),
)
_FIFTHS = tuple(round(0.2 * fifth, 1) for fifth in range(1, 11))
FIGURE_12_11 = _by_rate(
    {
        "true online Sarsa(λ)": {"algorithm": "true_online_sarsa_lambda", "trace_decay": 0.9},
        **{
            name: {"algorithm": "sarsa_lambda", "traces": traces, "trace_decay": 0.9}
            for name, traces in (
                ("replacing, clearing", "clearing"),
                ("replacing", "replacing"),
                ("accumulating", "accumulating"),
            )
        },
    },
    _FIFTHS,
    20,
    mean_return,
    "λ (0.9 here)",
    name="figure-12.11",
    title="Sarsa(λ) with four kinds of traces on Mountain Car",
    book="true online Sarsa(λ), and Sarsa(λ) with replacing traces, with replacing traces that clear the traces of "
    "the other actions, and with accumulating traces; the first 20 episodes, 100 runs",
    y_label="reward per episode",
    x_ticks=_FIFTHS,
    y_range=(-550, -150),
)

"""Figure 2.6: a parameter study of the bandit algorithms."""

from collections.abc import Mapping, Sequence
from typing import Any

from qtab.book.testbed import GREEDY, SAMPLE_AVERAGES, BanditSetting, TestbedExperiment

_UCB = {"exploration": "ucb", "ties": "random", "initial_q": 0.0}
_GRADIENT = {"algorithm": "gradient_bandit", "initial_q": 0.0}


def _powers(low: int, high: int) -> list[float]:
    return [2.0**exponent for exponent in range(low, high + 1)]


_METHODS: Sequence[tuple[str, str, list[float], str, Mapping[str, Any]]] = (
    ("ε-greedy (ε)", "ε-greedy", _powers(-7, -2), "epsilon", {**GREEDY, **SAMPLE_AVERAGES}),
    ("gradient bandit (α)", "gradient bandit", _powers(-5, 2), "learning_rate", _GRADIENT),
    ("UCB (c)", "UCB", _powers(-4, 2), "confidence", {**_UCB, **SAMPLE_AVERAGES}),
    (
        "greedy, optimistic, α = 0.1 (Q1)",
        "optimistic greedy",
        _powers(-2, 2),
        "initial_q",
        {**GREEDY, "learning_rate": 0.1, "learning_rate_schedule": "constant"},
    ),
)

EXPERIMENT = TestbedExperiment(
    name="figure-2.6",
    title="a parameter study of the bandit algorithms",
    book="the average reward of the first 1,000 steps by the parameter of each method: ε, α, c, or Q1 with α = 0.1",
    unspecified="the number of runs (2,000 here); ties (broken at random here)",
    settings=tuple(
        BanditSetting(line, {**config, parameter: value}, value, method=method)
        for line, method, values, parameter, config in _METHODS
        for value in values
    ),
    measures=("reward",),
    x_label="ε, α, c or Q1",
    y_label="average reward of the first 1,000 steps",
    log_x=True,
    x_ticks=tuple(_powers(-7, 2)),
    x_tick_labels=(*(f"1/{2**power}" for power in range(7, 0, -1)), "1", "2", "4"),
    y_range=(1.0, 1.56),
)

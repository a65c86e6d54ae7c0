"""The book's experiments that estimate values: their claims with fewer runs, and their pictures."""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.book.line import Line
from qtab.book.prediction_experiment import PredictionExperiment, PredictionSetting
from qtab.book.result import Result

NAMES = [name for name, one in qtab.book.EXPERIMENTS.items() if isinstance(one, PredictionExperiment)]


def short(name: str, keep: Callable[[PredictionSetting], bool] = lambda setting: True) -> PredictionExperiment:
    """An experiment with at most 300 episodes in each of the settings to keep."""
    experiment: Any = qtab.book.find(name)
    settings = []
    for setting in filter(keep, experiment.settings):
        episodes = min(setting.arguments["episodes"], 300)
        record = setting.arguments.get("record")
        arguments = {**setting.arguments, "episodes": episodes}
        x = setting.x
        if record is not None:
            arguments["record"] = [point for point in record if point <= episodes] or [episodes]
            if len(setting.x) == len(record):
                x = tuple(setting.x[: len({*arguments["record"], episodes})])
                arguments["record"] = sorted({*arguments["record"], episodes})
                x = tuple(float(point) for point in arguments["record"])
        settings.append(dataclasses.replace(setting, arguments=arguments, x=x))
    return dataclasses.replace(experiment, settings=tuple(settings))


def line(result: Result, name: str) -> Line:
    return next(line for line in result.lines if line.name == name)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] * (name == "figure-9.1"))  # a thousand states
        for name in NAMES
        if name != "figure-5.1"
    ],
)
def test_an_experiment_is_estimated_verified_and_drawn(name: str) -> None:
    experiment = short(name)
    # The first and the last line are enough.
    ends = {experiment.settings[0].line, experiment.settings[-1].line}
    some = [next(one for one in experiment.settings if one.line == end) for end in sorted(ends)]
    if name == "figure-9.1":
        some = list(experiment.settings)
    experiment = dataclasses.replace(experiment, settings=tuple(some))
    result = experiment.run(2)
    assert {line.name for line in result.lines} <= set(qtab.book.find(name).line_names)
    assert all(np.isfinite(line.mean).all() for line in result.lines)
    assert result.plot().get_title(loc="left")
    assert experiment.heading in str(result)


def test_batch_td_is_better_than_batch_monte_carlo() -> None:
    result = qtab.book.run("figure-6.2", runs=30)
    td, monte_carlo = line(result, "batch TD"), line(result, "batch MC")
    assert (td.mean[20:] + 2 * td.error[20:] < monte_carlo.mean[20:]).all()


def test_an_intermediate_n_is_best() -> None:
    best = {}
    for n in (1, 4, 64):
        experiment = short("figure-7.2", lambda setting, n=n: setting.line == f"n = {n}")  # type: ignore[misc]
        [found] = experiment.run(20).lines
        best[n] = found.mean.min()
    assert best[4] < min(best[1], best[64])
    # About 0.27 in the book.
    assert best[4] == pytest.approx(0.28, abs=0.02)


def test_weighted_importance_sampling_has_the_lower_error_at_first() -> None:
    result = short("figure-5.3").run(50)
    ordinary, weighted = result.lines
    assert weighted.mean[5] < ordinary.mean[5]


def test_the_value_of_the_blackjack_state_is_the_books() -> None:
    from qtab.book.problems import STATE, blackjack, index_of, single_state

    assert blackjack().true_values.values[STATE] == pytest.approx(-0.27726, abs=2e-4)
    assert single_state().true_values.values[index_of(STATE)] == pytest.approx(
        blackjack().true_values.values[STATE], abs=1e-12
    )
    result = short("figure-5.3").run(2)
    assert len(result.lines) == 2


def test_every_run_of_figure_5_4_is_a_line() -> None:
    result = short("figure-5.4").run(3)
    assert [line.name for line in result.lines] == ["run 1", "run 2", "run 3"]


def test_blackjack_surfaces_come_near_the_exact_values() -> None:
    from qtab.book.problems import blackjack

    result = qtab.book.run("figure-5.1")
    exact = blackjack().true_values.values[12:22, 1:11, 0]
    surface = result.surfaces["no usable ace, after 500,000 episodes"]
    assert np.abs(surface - exact).max() < 0.1
    assert len(result.plot().figure.axes) == 2

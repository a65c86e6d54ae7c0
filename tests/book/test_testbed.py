"""The book's experiments on the k-armed testbed: equal to training, and of the book's shapes."""

from typing import Any

import numpy as np
import pytest

import qtab
from qtab import _core
from qtab.book.testbed import ENV, TestbedExperiment, run_testbeds
from qtab.training.train_many import resolve_template

NAMES = [name for name, experiment in qtab.book.EXPERIMENTS.items() if isinstance(experiment, TestbedExperiment)]


def testbed(name: str) -> TestbedExperiment:
    experiment = qtab.book.find(name)
    assert isinstance(experiment, TestbedExperiment)
    return experiment


testbed.__test__ = False  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", NAMES)
def test_rewards_and_choices_are_those_of_training(name: str) -> None:
    experiment = testbed(name)
    for setting in {one.line: one for one in experiment.settings}.values():
        config: dict[str, Any] = {**experiment.config(setting), "episodes": 60}
        rewards, optimal = run_testbeds(config, range(3, 6), 2)
        for index, seed in enumerate(range(3, 6)):
            run = qtab.train(ENV, seed=seed, record=60, **config)
            assert rewards[index].tobytes() == run.episode_returns.tobytes()
            values = experiment.mean + np.random.default_rng(seed).standard_normal(10)
            chosen = [one.actions[0] == np.argmax(values) for one in run.recordings]
            assert (optimal[index] == 100.0 * np.array(chosen)).all()
        assert qtab.verify(run).equal


@pytest.mark.parametrize("name", NAMES)
def test_an_experiment_makes_a_table_and_a_picture(name: str) -> None:
    result = qtab.book.run(name, runs=2, seed=5)
    assert "FEWER" in str(result)
    assert "1,000 steps of each run" in " ".join(str(result).split())
    assert all(np.isfinite(line.mean).all() for line in result.lines)
    figure: Any = result.plot().figure
    assert sum(len(ax.lines) for ax in figure.axes) == len(result.lines)
    threads = qtab.book.run(name, runs=2, seed=5, threads=1)
    assert [line.mean.tobytes() for line in threads.lines] == [line.mean.tobytes() for line in result.lines]


def test_the_exemplary_problem_is_the_one_of_its_seed() -> None:
    result = qtab.book.run("2.1", seed=4)
    [line] = result.lines
    assert line.mean.tobytes() == np.random.default_rng(4).standard_normal(10).tobytes()
    assert "the problem of seed 4" in str(result)
    assert "std. error" not in str(result)
    ax = result.plot()
    assert len(ax.collections) == 10 + 1  # the distributions and the true values
    assert [tick.get_text() for tick in ax.get_xticklabels()] == [str(action) for action in range(1, 11)]


def test_figures_of_several_panels_need_axes_of_their_own() -> None:
    result = qtab.book.run("figure-2.2", runs=2)
    with pytest.raises(ValueError, match=r"^ax must be None for figure-2\.2, which creates its own axes"):
        result.plot(result.plot())


def test_the_order_of_the_methods_is_that_of_the_book() -> None:
    explored = {line.name: line.mean[-200:].mean() for line in qtab.book.run("figure-2.2", runs=300).lines}
    reward = [explored[f"ε = {epsilon}: average reward"] for epsilon in ("0", "0.01", "0.1")]
    assert reward == sorted(reward)
    assert 0.9 < reward[0] < 1.15 < 1.25 < reward[2] < 1.5
    gradient = {line.name: line.mean[-1] for line in qtab.book.run("figure-2.5", runs=300).lines}
    assert gradient["with baseline, α = 0.1"] > gradient["with baseline, α = 0.4"] > 55
    assert gradient["without baseline, α = 0.4"] < gradient["without baseline, α = 0.1"] < 60


BOOK: dict[str, Any] = {"episodes": 30, "max_episode_steps": 1, "seed": None}


@pytest.mark.parametrize(
    "settings",
    [
        {"count_bonus": 3.0},
        {"algorithm": "sarsa", "on_truncation": "terminate"},
        {"algorithm": "double_q_learning", "epsilon": 0.3},
        {"time_aware": True},
        {"bit_generator": "MT19937"},
        {"exploration": "softmax", "temperature": 0.5},
        {"exploration": "ucb", "confidence": 2.0, "count_bonus": 1.0},
        {"initial_q": np.array([[-np.inf] + [0.0] * 9])},
        {"action_mask": lambda _: np.arange(10) < 3},
        {"env_kwargs": {"random_walk": 0.1}, "learning_rate": 0.1, "learning_rate_schedule": "linear"},
    ],
    ids=lambda settings: "-".join(settings),
)
def test_a_testbed_honours_every_setting_that_training_honours(settings: dict[str, Any]) -> None:
    config = {**BOOK, "algorithm": "q_learning", **settings}
    rewards, optimal = run_testbeds(config, range(2), 1)
    for seed in range(2):
        run = qtab.train(ENV, **{**config, "seed": seed}, record=30)
        assert rewards[seed].tobytes() == run.episode_returns.tobytes()
        assert qtab.verify(run).equal
        if "env_kwargs" not in settings:
            best = np.argmax(np.random.default_rng(seed).standard_normal(10))
            assert optimal[seed].tolist() == [100.0 * (one.actions[0] == best) for one in run.recordings]


@pytest.mark.parametrize(
    "settings",
    [
        {"algorithm": "gradient_bandit", "learning_rate": 1e-308, "env_kwargs": {"deviation": 1.7e308}},
        {"algorithm": "q_learning", "learning_rate_schedule": "constant", "initial_q": -1.7e308}
        | {"env_kwargs": {"mean": 1.7e308}},
    ],
    ids=lambda settings: settings["algorithm"],
)
def test_a_testbed_ends_where_a_learner_diverges(settings: dict[str, Any]) -> None:
    config = {**BOOK, **settings}
    for train in (lambda: qtab.train(ENV, **{**config, "seed": 0}), lambda: run_testbeds(config, range(2), 1)):
        with pytest.raises(OverflowError, match=r"^the action values overflowed (in|by) episode \d+ "):
            train()


def test_a_testbed_is_a_bandit_that_rust_steps() -> None:
    resolved = resolve_template("CliffWalking-v1", {"episodes": 2, "seed": 0})
    rewards, optimal = np.empty((1, 2)), np.empty((1, 2), np.bool_)
    with pytest.raises(ValueError, match=r"^env must be a k-armed bandit, got another environment"):
        _core.run_testbeds(resolved.spec(), [0], rewards, optimal, 1)
    with pytest.raises(
        ValueError, match=r"^env must be a k-armed bandit that Rust steps, got one that is stepped in Py"
    ):
        run_testbeds({"backend": "gymnasium", "episodes": 2}, range(1), 1)
    bandit = resolve_template(ENV, {"episodes": 3, "seed": 0})
    with pytest.raises(ValueError, match=r"^rewards must be an array of shape \(1, 3\), got \[1, 2\]"):
        _core.run_testbeds(bandit.spec(), [0], rewards, optimal, 1)

"""The notebooks in examples/chapters/ show what their sentences state; tested with ``-m docs`` only."""

import itertools
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import qtab
from support.documents.notebooks import EXAMPLES, Executed, check_shown, source
from support.repository import ROOT

PICTURES = {
    "chapter_2": "problem estimates epsilon-greedy optimism ucb moving",
    "chapter_4": "evaluation in-place jack gambler coins lake",
    "chapter_5": "values error control control-gap off-policy",
    "chapter_6": "windy-policy cliff cliff-policies bias",
    "chapter_8": "maze policies blocking shortcut updates",
    "chapter_9": "staircase sizes tilings",
    "chapter_10": "cost tables steps queue",
    "chapter_12": "one td-lambda true-online control kinds",
    "chapter_13": "corridor reinforce paths baseline",
}
"""The cells that show one picture each."""
TABLES = {"chapter_6": "windy compare experiment"}
"""The cells that show a table."""


def test_each_is_tested_and_the_page_for_teachers_links_it() -> None:
    names = sorted(path.stem for path in (EXAMPLES / "chapters").glob("*.ipynb"))
    assert names == sorted(PICTURES)
    page = (ROOT / "docs" / "teaching" / "lectures.md").read_text(encoding="utf-8")
    assert [name for name in names if f"(../../examples/chapters/{name}.ipynb)" not in page] == []


def found(pattern: str, text: str) -> list[str]:
    """Returns the different matches in order."""
    return list(dict.fromkeys(re.findall(pattern, text)))


def check_chapter_2(executed: Executed) -> None:
    """The greedy agent takes the eighth action, never the best one, and α = 0.1 is best on the moving values."""
    counts = [re.findall(r"\d+", line) for line in found(r"visits \[(.*)\]", executed.text("one-run"))]
    greedy, exploring = np.array(counts, dtype=int)
    assert (greedy[7], greedy[6]) == (997, 0)
    assert exploring.argmax() == 6
    assert exploring.min() > 0
    figure = qtab.book.run("figure-2.2", runs=500)
    last = {line.name: line.mean[-1] for line in figure.lines}
    assert last["ε = 0: average reward"] < last["ε = 0.01: average reward"] < last["ε = 0.1: average reward"]
    settings: dict[str, Any] = {"qtab": qtab}
    for cell in ("one-run", "moving"):
        exec(re.split(r"^(?:agents|moving) = ", source("chapters/chapter_2", cell), flags=re.M)[0], settings)  # noqa: S102
    final = {
        name: qtab.train_many(
            "qtab/KArmedBandit-v0",
            50,
            episodes=10_000,
            env_kwargs=settings["walk"],
            epsilon=0.1,
            **settings["bandit"],
            **method,
        )
        .final_returns(1000)
        .mean()
        for name, method in settings["methods"].items()
    }
    assert max(final, key=final.__getitem__) == "α = 0.1"


def check_chapter_4(executed: Executed) -> None:
    in_place, two_arrays = (int(number) for number in re.findall(r"(\d+)", executed.text("in-place"))[-2:][::-1])
    assert in_place < two_arrays * 2 / 3
    assert found(r"(\d+) of 441", executed.text("jack-changes")) == ["318", "272", "79", "8"]
    first, second, third = itertools.islice(qtab.planning.value_iteration("qtab/GamblersProblem-v0"), 1, 4)
    assert [np.flatnonzero(values).min() for values in (first, second, third)] == [50, 25, 13]
    assert executed.text("lake").startswith("probability of reaching the goal: 0.7402")
    sweeps = [*itertools.islice(qtab.planning.value_iteration("CliffWalking-v1"), 20)]
    assert [np.array_equal(values, sweeps[-1]) for values in sweeps].index(True) == 14
    for probability, wins in ((0.4, False), (0.55, True)):
        best = qtab.optimum(
            "qtab/GamblersProblem-v0", method="policy_iteration", env_kwargs={"probability": probability}
        )
        assert (best.values[20] > 0.95) == wins


def check_chapter_5(executed: Executed) -> None:
    errors = [float(error) for error in found(r"error ([\d.]+)", executed.text("error"))]
    # 1,000 and 10,000 episodes: a factor of about √10.
    assert 2.5 < errors[2] / errors[4] < 4
    losses = [float(loss) for loss in found(r"0\.\d{4}", executed.text("control-gap"))]
    best, learned, sticks = losses
    assert best < learned < best + 0.002
    assert sticks > 0.3
    (ordinary, weighted) = qtab.book.run("figure-5.3").lines
    assert ordinary.mean[0] > 5 * weighted.mean[0]
    assert ordinary.mean[-1] < 0.01


def check_chapter_6(executed: Executed) -> None:
    assert found(r"(?:optimum|greedy policy): (\S+)", executed.text("windy-gap")) == ["-15.0"]
    assert executed.text("step").count("target = R + γ Q(S', A')") == 2
    settings: dict[str, Any] = {}
    exec(source("chapters/chapter_6", "windy").partition("windy =")[0], settings)  # noqa: S102 - our own notebook
    for algorithm in ("sarsa", "q_learning"):
        runs = qtab.train_many("CliffWalking-v1", 200, algorithm=algorithm, episodes=500, **settings["settings"])
        assert str(qtab.stats.mean(runs.final_returns())) in executed.text("cliff-returns")
    assert "optimum: -13.0" in executed.text("cliff-greedy")
    assert "Q-learning      200 of 200" in executed.text("cliff-greedy")
    assert "Sarsa           0 of 200" in executed.text("cliff-greedy")
    assert str(qtab.book.run("figure-6.5", runs=1000)).splitlines()[-2] in executed.text("bias-table")


def check_chapter_8(executed: Executed) -> None:
    known = [int(cells) for cells in found(r"cells with a value above 0: (\d+)", executed.text("policies"))]
    assert known[0] == 2
    assert known[1] > 40
    lines = {line.name: line.mean for line in qtab.book.run("figure-8.2").lines}
    assert min(values[0] for values in lines.values()) > 500
    assert lines["n = 50"][2] < 20
    for name, change in (("figure-8.4", 1000), ("figure-8.5", 3000)):
        reward = {line.name: line.mean[-1] for line in qtab.book.run(name, runs=10).lines}
        assert reward["Dyna-Q+"] > reward["Dyna-Q"], change


def check_chapter_9(executed: Executed) -> None:
    """An episode takes 83 steps, and the errors are in the order that the sentences state."""
    assert executed.text("walk").strip() == ""
    walk: dict[str, Any] = {"env_kwargs": {"states": 1000, "reach": 100}}
    exact = qtab.policy_values("qtab/RandomWalk-v0", "random", **walk)
    assert exact.visits.sum() == pytest.approx(83, abs=0.5)
    assert exact.state_distribution.max() == pytest.approx(0.014, abs=0.001)
    features: dict[Any, Any] = {
        **{width: qtab.prediction.state_aggregation(1000, width) for width in (500, 50)},
        "tilings": qtab.prediction.tile_coding(1000, width=200, tilings=50, offset=4),
    }
    errors = {
        name: qtab.estimate_values(
            "qtab/RandomWalk-v0",
            "random",
            method="monte_carlo",
            features=active,
            learning_rate=1e-4,
            episodes=3000,
            record=[100, 3000],
            max_episode_steps=10_000,
            **walk,
        ).rms_error(exact, exact.state_distribution)[0]
        for name, active in features.items()
    }
    assert errors[500][0] < errors[50][0]
    assert errors[500][1] > errors[50][1] > errors["tilings"][1]


def check_chapter_10(executed: Executed) -> None:
    coarse, fine, tiles = (float(mean) for mean in found(r"episodes: (-[\d.]+) \[", executed.text("table-returns")))
    assert coarse < fine < -150 < -120 < tiles


def check_chapter_12(executed: Executed) -> None:
    means = dict(re.findall(r"([\d.]+): ([\d.]+)", executed.text("control")))
    assert min(means, key=lambda decay: float(means[decay])) == "0.95"
    for decay, learned in ((0.0, 1), (0.5, 5), (0.9, 14)):
        values = qtab.estimate_values(
            "qtab/RandomWalk-v0",
            "random",
            method="td_lambda",
            trace_decay=decay,
            learning_rate=0.3,
            episodes=1,
            seeds=[1],
            max_episode_steps=10_000,
        ).mean
        assert (values > 0.005).sum() >= learned
        assert (values[:-1] != 0).any() == (decay > 0)
        assert values.argmax() + 1 == (15 if decay == 0.9 else 19)


def check_chapter_13(executed: Executed) -> None:
    assert found(r"greedy policy (-?\d+)", executed.text("values")) == ["-1000"]
    assert min(float(mean) for mean in re.findall(r"episodes (-[\d.]+),", executed.text("values"))) > -44
    rights = []
    for seed in range(20):
        run = qtab.train(
            "qtab/ShortCorridor-v0", preset="book", learning_rate=2.0**-12, seed=seed, max_episode_steps=1000
        )
        left, right = run.q_table[0]
        rights.append(1 / (1 + np.exp(left - right)))
    assert sum(right > 0.95 for right in rights) == 1
    assert 0.5 < np.median(rights) < 0.65
    figure = qtab.book.run("figure-13.2")
    with_baseline, without = (line.mean for line in figure.lines[:2])
    assert abs(with_baseline[90:110].mean() - without[-100:].mean()) < 3


CHECKS: dict[str, Callable[[Executed], None]] = {
    "chapter_2": check_chapter_2,
    "chapter_4": check_chapter_4,
    "chapter_5": check_chapter_5,
    "chapter_6": check_chapter_6,
    "chapter_8": check_chapter_8,
    "chapter_9": check_chapter_9,
    "chapter_10": check_chapter_10,
    "chapter_12": check_chapter_12,
    "chapter_13": check_chapter_13,
}


@pytest.mark.docs
@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of Jupyter's libraries
@pytest.mark.parametrize("name", PICTURES)
def test_a_chapter_shows_what_it_says(name: str, tmp_path: Path) -> None:
    check_shown(f"chapters/{name}", tmp_path, pictures=PICTURES[name], tables=TABLES.get(name, ""), check=CHECKS[name])

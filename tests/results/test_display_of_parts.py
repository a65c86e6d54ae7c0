"""How the parts of results are shown: one short line, and a table in notebooks where there is more to see."""

import inspect
import xml.etree.ElementTree as ElementTree
from functools import cache
from typing import Any

import numpy as np
import pytest

import qtab
from qtab import callbacks, stats
from qtab._utils import html
from qtab.discretizers import DISCRETIZERS, Discretizer
from qtab.discretizers.named import class_at
from qtab.discretizers.weighted.features import WeightedFeatures

NAME = "<b>&name</b>"


@cache
def run() -> qtab.Run:
    return qtab.train("MountainCar-v0", seed=0, episodes=120, record=1, snapshots=2)


@cache
def lake() -> qtab.Run:
    return qtab.train("FrozenLake-v1", seed=0, episodes=200)


@cache
def sweep() -> qtab.Sweep:
    return qtab.sweep("FrozenLake-v1", {"learning_rate": [0.1, 0.5]}, seeds=3, episodes=120)


@cache
def diagnosis() -> qtab.Diagnosis:
    return qtab.diagnose(lake())


def progress() -> qtab.Progress:
    seen: list[qtab.Progress] = []
    qtab.train("FrozenLake-v1", seed=0, episodes=200, callback=seen.append)
    return seen[0]


def gap(runs: qtab.Run | qtab.Runs) -> Any:
    return qtab.optimum("FrozenLake-v1").gap(runs)


PARTS: dict[str, tuple[Any, str]] = {
    "discretizer": (lambda: run().discretizer, "<Rounding: 19 × 15 cells>"),
    "tile coding": (
        lambda: qtab.train("MountainCar-v0", preset="solved", seed=0, episodes=1).discretizer,
        "<TileCoding: 2,592 rows, 32 of them active>",
    ),
    "actions": (lambda: run().actions, "<Actions: 3, numbered from 0>"),
    "actions of a Box": (
        lambda: qtab.train("Pendulum-v1", seed=0, episodes=1).actions,
        "<Actions: 3, [-2.0, 0.0, 2.0]>",
    ),
    "axis": (lambda: run().axes[0], "<Axis position (m): 19 cells from -1.2 to 0.6>"),
    "axis without cells": (
        lambda: qtab.train("MountainCar-v0", discretizer="fourier", seed=0, episodes=1).axes[0],
        "<Axis position (m): from -1.2 to 0.6>",
    ),
    "state": (lambda: run().state, "<RunState of "),
    "recording": (lambda: run().recordings[0], "<Recording of episode 119: 200 actions>"),
    "snapshots": (lambda: run().snapshots, "<2 Snapshots, after episodes 60 to 120>"),
    "progress": (progress, "<Progress: 100 of 200 episodes, the last 100 at 0.0"),
    "verification": (
        lambda: qtab.verify(lake(), episodes=1),
        "<Verification of FrozenLake-v1: seed 0, 1 episode, equal>",
    ),
    "gap": (lambda: gap(lake()), "<Gap: greedy policy "),
    "gap of many": (
        lambda: gap(qtab.train_many("FrozenLake-v1", 3, episodes=120, tables=True)),
        "<Gap of 3 runs: greedy policy ",
    ),
    "finding": (lambda: diagnosis().findings[0], "<Finding 'not solved': The run did not solve"),
    "trial": (lambda: diagnosis().what_if(2).best, "<Trial of "),
    "confirmation": (lambda: sweep().confirm(3), "<Confirmation of 1 of 2 settings"),
    "interval": (lambda: stats.mean([1.0, 2.0, 3.0]), "<Interval 2.0 [-0.5, 4.5], 95 %, t>"),
    "comparison": (lambda: stats.compare([1.0, 2.0, 4.0], [0.0, 1.0, 2.0]), "<Comparison: difference 1.3 ["),
    "line": (lambda: qtab.book.run("example-6.5", runs=2).lines[0], "<Line "),
    "experiment": (lambda: qtab.book.find("10.1"), "<CostToGo Figure 10.1: the cost-to-go of Mountain Car>"),
    "table environment": (lambda: qtab.TabularEnv([[[(1.0, 0, 0.0, True)]]], [1.0]), "<TabularEnv: 1 state, 1 action>"),
    "checkpoint": (lambda: callbacks.Checkpoint("run.npz", 50), "Checkpoint(path='run.npz', every=50)"),
    "evaluation": (lambda: callbacks.EvaluateEvery(5, seed=1), "EvaluateEvery(episodes=5, seed=1)"),
}
TABLES = ["discretizer", "tile coding", "verification", "gap", "gap of many", "finding", "confirmation", "comparison"]


@pytest.mark.parametrize("name", PARTS)
def test_the_repr_is_one_short_line(name):
    make, expected = PARTS[name]
    shown = repr(make())
    assert shown.startswith(expected)
    assert "\n" not in shown
    assert len(shown) < 200


def public_classes() -> list[type]:
    modules = [qtab, stats, callbacks, qtab.book]
    found = [getattr(module, name) for module in modules for name in module.__all__]
    return [one for one in found if inspect.isclass(one)]


def test_no_public_object_is_shown_by_its_address():
    assert len(public_classes()) > 30
    without = [cls for cls in public_classes() if all("__repr__" not in vars(base) for base in cls.__mro__[:-1])]
    assert without == []


def test_every_discretizer_is_shown_in_one_line():
    # A dataclass would make one of its own, with all edges.
    shown = {class_at(place).__repr__ for place in DISCRETIZERS.values()}
    assert shown == {Discretizer.__repr__, WeightedFeatures.__repr__}


def tables(shown: str) -> list[list[str]]:
    """The texts of the rows of the tables."""
    root = ElementTree.fromstring(shown)  # noqa: S314
    return [["".join(cell.itertext()) for cell in row] for row in root.iter("tr")]


@pytest.mark.parametrize("name", TABLES)
def test_notebooks_show_a_table(name):
    shown = PARTS[name][0]()._repr_html_()
    assert len(tables(shown)) > 1
    assert "nan" not in shown.lower()
    assert "color:#" not in shown  # text has the color of the page, light or dark


def test_a_config_is_a_table_of_the_settings_that_apply():
    shown = dict(tables(run().config._repr_html_()))
    assert shown["algorithm"] == "'q_learning'"
    assert shown["scale"] == "(10.0, 100.0)"
    assert "tiles" not in shown
    started = run().config.replace(initial_q=np.zeros((1, 285, 3)))
    assert dict(tables(started._repr_html_()))["initial_q"] == "array of shape (1, 285, 3)"


def test_a_step_and_an_experiment_are_tables():
    [step] = qtab.explain(run(), episode=3, steps=1).steps
    shown = dict(tables(step._repr_html_()))
    assert shown["state"] == step.state
    assert step.updates[0].numbers[-1] in shown["update"]
    experiment = qtab.book.find("example-6.5")
    assert dict(tables(experiment._repr_html_()))["run it"] == "qtab.book.run('example-6.5')"


def test_a_verification_that_fails_says_where():
    run = lake()
    wrong = run.episode_returns.copy()
    wrong[7] += 1
    object.__setattr__(run, "episode_returns", wrong)
    lake.cache_clear()
    verification = qtab.verify(run, episodes=9)
    assert repr(verification).endswith("9 episodes, DIFFERENT from episode 7 on>")
    assert dict(tables(verification._repr_html_()))["returns"] == "DIFFERENT"


def test_sentences_are_escaped_and_not_cut():
    long = f"{NAME}\n" + "word " * 100
    shown = html.sentences(NAME, [NAME, NAME], [[long, NAME]], [NAME])
    head, row = tables(shown)
    assert head == [NAME, NAME]
    assert row == [long.replace("\n", ""), NAME]
    assert shown.count("<b>") == 1  # the title of the row
    assert ElementTree.fromstring(shown).findtext(".//caption") == NAME  # noqa: S314


def test_a_heading_is_as_wide_as_its_text_and_not_as_a_narrow_table():
    caption = ElementTree.fromstring(html.sentences(NAME, ["a"], [["b"]], [])).find(".//caption")  # noqa: S314
    assert caption is not None
    assert "width:max-content;max-width:90vw" in caption.get("style", "")


def test_a_callback_of_your_own_shows_what_it_was_given():
    class Mine(callbacks.BaseCallback):
        def __init__(self, target: float, every: int | None = None, *rest: Any, **more: Any) -> None:
            super().__init__(every)

        def __call__(self, progress: qtab.Progress) -> None: ...

    assert repr(Mine(3.0, 7)) == "Mine(every=7)"


def test_the_name_of_an_environment_is_escaped_everywhere():
    named = type(NAME, (qtab.TabularEnv,), {})
    chain = [[[(1.0, 1, -1.0, False)], [(1.0, 0, -1.0, False)]], [[(1.0, 1, 0.0, True)], [(1.0, 0, -1.0, False)]]]
    env = named(chain, [1.0, 0.0])
    run = qtab.train(env, seed=0, episodes=200, max_episode_steps=20)
    best = qtab.optimum(env, max_episode_steps=20)
    results: list[Any] = [
        run,
        run.config,
        best,
        qtab.diagnose(run, best),
        qtab.explain(run, episode=0, steps=1, env=env),
        qtab.verify(run, episodes=2, env=env),
    ]
    for result in results:
        shown = result._repr_html_()
        assert NAME not in shown, result
        assert NAME in "".join(ElementTree.fromstring(shown).itertext())  # noqa: S314

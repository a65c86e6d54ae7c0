"""How results are shown: one short line, and in notebooks a small table beside a small picture."""

import dataclasses
import xml.etree.ElementTree as ElementTree
from functools import cache
from typing import Any

import numpy as np
import pytest

import qtab
from qtab._utils import html

GRID: dict[str, list[Any]] = {"learning_rate": [0.1, 0.5], "algorithm": ["sarsa", "q_learning"]}
MAX_LENGTH = 20_000


def diverged_sweep() -> qtab.Sweep:
    return qtab.sweep(
        "MountainCar-v0",
        {"learning_rate": [0.1, 2.0]},
        seeds=2,
        episodes=20,
        preset="solved",
        algorithm="sarsa_lambda",
        traces="accumulating",
        trace_decay=1.0,
        discount=1.0,
        tilings=32,
    )


RESULTS: dict[str, Any] = {
    "run": lambda: qtab.train("MountainCar-v0", seed=0, episodes=300),
    "long run": lambda: qtab.train("FrozenLake-v1", seed=0, episodes=20_001),
    "run of one episode": lambda: qtab.train("FrozenLake-v1", seed=0, episodes=1),
    "run of no episode": lambda: stopped(qtab.train("FrozenLake-v1", seed=0, episodes=1)),
    "run of a Box": lambda: qtab.train("Pendulum-v1", seed=0, episodes=20, max_episode_steps=10),
    "runs": lambda: qtab.train_many("CartPole-v1", seeds=4, episodes=50),
    "one run": lambda: qtab.train_many("CartPole-v1", seeds=1, episodes=1),
    "no runs": lambda: qtab.train_many("CartPole-v1", seeds=1, episodes=5)[1:],
    "sweep": lambda: qtab.sweep("FrozenLake-v1", GRID, seeds=3, episodes=200),
    "sweep with failed runs": diverged_sweep,
    "optimum of a table": lambda: qtab.optimum("CliffWalking-v1"),
    "optimum of three numbers": lambda: qtab.optimum("Blackjack-v1"),
    "evaluation": lambda: qtab.evaluate(qtab.train("CartPole-v1", seed=0, episodes=20), 30, seed=0),
    "evaluation of one episode": lambda: qtab.evaluate(qtab.train("Taxi-v4", seed=0, episodes=2), 1, seed=0),
    "experiment": lambda: qtab.book.run("example 6.6", runs=2),
    "experiment with one run": lambda: qtab.book.run("example 6.5", runs=1),
}


def stopped(run: qtab.Run) -> qtab.Run:
    arrays = {name: getattr(run, name)[:0] for name in ("episode_returns", "episode_lengths", "terminated")}
    return dataclasses.replace(run, completed=False, **arrays)


@cache
def made(name: str) -> Any:
    return RESULTS[name]()


@pytest.fixture(params=list(RESULTS))
def result(request) -> Any:
    return made(request.param)


def test_the_repr_is_one_short_line(result):
    assert repr(result).startswith(f"<{type(result).__name__} of ")
    assert repr(result).endswith(">")
    assert "\n" not in repr(result)
    assert len(repr(result)) < 200


def test_notebooks_show_valid_markup_without_anything_from_the_network(result):
    shown = result._repr_html_()
    assert len(shown) < MAX_LENGTH
    assert len(ElementTree.fromstring(shown).findall(".//table")) == 1  # noqa: S314
    for word in ("<script", "http://", "https://", "url(", "src=", "href="):
        assert word not in shown.replace('xmlns="http://www.w3.org/2000/svg"', "")
    assert "nan" not in shown.lower()
    assert "color:#" not in shown  # text has the color of the page, light or dark


def test_pictures_are_named_for_those_who_do_not_see_them(result):
    root = ElementTree.fromstring(result._repr_html_().replace(' xmlns="http://www.w3.org/2000/svg"', ""))  # noqa: S314
    for picture in root.iter("svg"):
        title = picture.find("title")
        assert title is not None
        assert picture.get("role") == "img"
        assert picture.get("aria-label") == title.text
        assert title.text


@pytest.mark.parametrize("name", ["run", "runs", "sweep", "optimum of a table", "evaluation", "experiment"])
def test_there_is_a_picture_where_there_is_something_to_draw(name):
    assert "<svg" in made(name)._repr_html_()


def test_every_text_is_escaped():
    text = "<script>alert('&\"')</script>"
    shown = html.summary(text, {text: text}, html.lines(text, {text: [0.0, 1.0]}))
    shown += html.listing(text, [text, text], [[text, text]], html.bars(text, [1, 2], text, text))
    assert "<script" not in shown
    texts = {element.text for element in ElementTree.fromstring(f"<div>{shown}</div>").iter()}  # noqa: S314
    assert text in texts
    run = dataclasses.replace(made("run"), config=qtab.train("FrozenLake-v1", episodes=1).config.replace(env=text))
    assert "<script" not in run._repr_html_()


def paths(picture: str) -> list[str]:
    root = ElementTree.fromstring(picture.replace(' xmlns="http://www.w3.org/2000/svg"', ""))  # noqa: S314
    return [path.get("d", "") for path in root.iter("path")]


def test_a_line_goes_from_the_lowest_value_to_the_highest():
    [path] = paths(html.lines("title", {"name": [0.0, 5.0, 10.0]}))
    points = [[float(number) for number in point.split()] for point in path[1:].split("L")]
    assert [x for x, _ in points] == sorted(x for x, _ in points)
    assert points[0][1] == html.HEIGHT - points[2][1]
    assert points[0][1] > points[1][1] == html.HEIGHT / 2 > points[2][1]


@pytest.mark.parametrize(
    "curve", [[], [1.0], [np.nan, np.nan], [1.7e308, -1.7e308, 0.0], [1.0, np.nan, np.inf], [3.0] * 10_000], ids=str
)
def test_odd_curves_are_drawn_or_left_out(curve):
    picture = html.lines("title", {"name": curve})
    assert all("nan" not in path and "inf" not in path for path in (paths(picture) if picture else []))
    assert len(picture) < 4000


def test_the_cells_of_a_field_are_all_drawn_the_lowest_lightest():
    values = np.arange(6.0).reshape(2, 3)
    drawn = paths(html.field("title", values))
    assert sum(path.count("h1v1h-1z") for path in drawn) == 6
    assert drawn[0] == "M0 0h1v1h-1z"
    large = html.field("title", np.random.default_rng(0).random((300, 500)))
    assert len(large) < MAX_LENGTH
    assert html.field("title", np.array([[np.nan]])) == ""

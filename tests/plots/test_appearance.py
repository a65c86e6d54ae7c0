"""Legends and titles cover nothing in axes of any size; colors are readable, and the same for the same algorithm."""

from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.colors import to_rgb

import qtab
from qtab import plots
from qtab.config.choices import ALGORITHM_NAMES, CHOICES
from qtab.plots.parts.axes import new_figure
from qtab.plots.parts.colors import COLORS
from qtab.plots.parts.labels import finish

RETURNS = np.cumsum(np.random.default_rng(0).normal(1, 5, size=(12, 300)), axis=1)
RUN = qtab.train("MountainCar-v0", seed=0, episodes=120)
STUDY = qtab.sweep(
    "CliffWalking-v1",
    {"learning_rate": [0.1, 0.5, 1.0], "algorithm": ["q_learning", "true_online_sarsa_lambda"]},
    seeds=3,
    episodes=40,
    max_episode_steps=100,
    block=10,
)
DRAWN = {
    "plot": lambda ax: qtab.plot(RUN, ax, optimum=-97.7),
    "learning_curves": lambda ax: plots.learning_curves(
        {"a long name of a setting": RETURNS, "b": -RETURNS}, ax, title="t"
    ),
    "sweep": lambda ax: plots.learning_curves(STUDY, ax),
    "distribution": lambda ax: plots.distribution({"a": RETURNS[:, -1], "b": RETURNS[:, 0]}, ax),
    "profile": lambda ax: plots.profile({"a": RETURNS[:, -1], "b": RETURNS[:, 0]}, ax),
    "sensitivity": lambda ax: plots.sensitivity(STUDY, "learning_rate", ax, by="algorithm"),
    "categories": lambda ax: plots.sensitivity(STUDY, "algorithm", ax),
}


def luminance(color: Any) -> float:
    return float(np.dot(to_rgb(color), (0.2126, 0.7152, 0.0722)))


@pytest.mark.parametrize(
    ("size", "layout"), [((2.6, 2.4), None), ((2.6, 2.4), "constrained"), ((8, 4.5), "constrained")], ids=str
)
@pytest.mark.parametrize("draw", DRAWN.values(), ids=DRAWN)
def test_a_legend_covers_neither_labels_nor_data_and_stays_in_the_figure(draw: Any, size: Any, layout: Any) -> None:
    figure, ax = plt.subplots(figsize=size, layout=layout)
    draw(ax)
    figure.canvas.draw()
    drawn: Any = ax.get_legend()
    legend = drawn.get_window_extent()
    texts = [ax.xaxis.label, ax.yaxis.label, ax.title, ax._left_title, ax._right_title, *ax.get_xticklabels()]  # type: ignore[attr-defined]
    for text in [*texts, *ax.texts]:
        if text.get_text() and text.get_visible():
            box = text.get_window_extent()
            assert (
                min(legend.x1, box.x1) - max(legend.x0, box.x0) < 1
                or min(legend.y1, box.y1) - max(legend.y0, box.y0) < 1
            )
    for line in ax.lines:
        data = np.asarray(line.get_xydata(), dtype=float)
        if len(data) > 2:  # not a line across the axes
            pixels = ax.transData.transform(data)
            inside = (pixels > (legend.x0, legend.y0)) & (pixels < (legend.x1, legend.y1))
            assert not inside.all(axis=1).any()
    assert legend.y0 > -2
    assert legend.x1 < figure.bbox.x1 + 2


@pytest.mark.parametrize("width", [2.0, 3.0, 5.0, 8.0])
def test_the_title_and_the_settings_of_a_run_do_not_overlap(width: float) -> None:
    figure, ax = plt.subplots(figsize=(width, 3), layout="constrained")
    qtab.plot(RUN, qtab.plot(RUN, ax))  # a second run on the same axes replaces the first one's settings
    figure.canvas.draw()
    title, note = ax._left_title.get_window_extent(), [*ax.texts, ax._right_title]  # type: ignore[attr-defined]
    [settings] = [text for text in note if text.get_text()]
    assert "seed 0" in settings.get_text().replace("\n", " ")
    box = settings.get_window_extent()
    assert box.x0 > title.x1 or box.y1 < title.y0
    assert box.y0 > ax.get_window_extent().y1
    assert box.x1 < figure.bbox.x1


@pytest.mark.parametrize("width", [4.0, 6.0, 8.0])
def test_a_long_title_fills_its_lines_and_stays_in_the_figure(width: float) -> None:
    figure = new_figure(width, 4.5)
    ax = figure.subplots()
    ax.plot([1, 2], [-2000, 0])
    finish(ax, "Episode", "Return", "Example 6.6: Sarsa and Q-learning on the cliff, mean returns of 100 episodes")
    figure.draw_without_rendering()
    extent = ax._left_title.get_window_extent()  # type: ignore[attr-defined]
    assert extent.x1 <= figure.bbox.x1
    lines = ax.get_title("left").split("\n")
    assert len(lines) > 1
    needed = extent.width * (len(lines[0]) + 1 + len(lines[1].split()[0])) / max(map(len, lines))
    assert needed > 0.85 * ax.get_window_extent().width  # there was no room for the next word


@pytest.mark.parametrize("draw", DRAWN.values(), ids=DRAWN)
def test_lines_are_readable_on_a_dark_background(draw: Any) -> None:
    with plt.style.context("dark_background"):
        ax = draw(plt.figure().subplots())
        for line in ax.lines:
            assert luminance(line.get_color()) > 0.15, line.get_label()
        texts = [ax._left_title, ax._right_title, *ax.texts, *ax.get_legend().get_texts()]
        assert min(luminance(text.get_color()) for text in texts) > 0.5


def test_an_algorithm_has_the_same_color_in_every_plot() -> None:
    runs = {
        name: qtab.train_many("CliffWalking-v1", 2, algorithm=name, episodes=20, max_episode_steps=50)
        for name in ("sarsa", "dyna_q")
    }
    sarsa, dyna = COLORS[1], COLORS[8]
    reordered = {"dyna": runs["dyna_q"], "sarsa": runs["sarsa"]}
    for ax in (plots.learning_curves(runs), plots.learning_curves(reordered), plots.profile(reordered)):
        by_label = {str(line.get_label()): line.get_color() for line in ax.lines}
        assert by_label.pop("sarsa") == sarsa
        assert dyna in by_label.values()
    assert (
        qtab.plot(qtab.train("CliffWalking-v1", algorithm="sarsa", episodes=9, max_episode_steps=9))
        .lines[1]
        .get_color()
        == sarsa
    )
    assert plots.learning_curves(runs["dyna_q"]).lines[-1].get_color() == dyna
    assert plots.learning_curves(runs["dyna_q"], index=0).lines[-1].get_color() == COLORS[0]
    assert [line.get_color() for line in plots.sensitivity(STUDY, "learning_rate", by="algorithm").lines[:2]] == [
        COLORS[0],
        COLORS[6],
    ]


@pytest.mark.parametrize(
    ("label", "algorithm"), [*((name, key) for key, name in ALGORITHM_NAMES.items()), ("Q learning", "q_learning")]
)
def test_an_algorithm_is_known_by_its_name_in_the_book(label: str, algorithm: str) -> None:
    [line] = plots.profile({label: [1.0, 2.0]}).lines
    assert line.get_color() == COLORS[CHOICES["algorithm"].index(algorithm) % len(COLORS)]
    assert plots.profile({"mine": [1.0], label: [2.0]}).lines[1].get_color() == COLORS[1]


def test_ordered_values_have_sequential_colors() -> None:
    ax = plots.sensitivity(STUDY, "algorithm", by="learning_rate")
    containers: list[Any] = ax.containers
    hues = [container.lines[0].get_color() for container in containers]
    lightness = [luminance(hue) for hue in hues]
    assert len(hues) == 3
    assert lightness == sorted(lightness)
    assert not set(hues) & set(COLORS)


def test_colors_are_those_that_the_user_gives() -> None:
    named = {"a": RETURNS, "b": -RETURNS, "c": RETURNS}
    for colors in (["red", "C1", "#123456"], {"c": "#123456", "a": "red", "b": "C1"}):
        drawn = plots.learning_curves(named, colors=colors).lines
        assert [line.get_color() for line in drawn] == ["red", "C1", "#123456"]
    assert qtab.plot(RUN, color="red").lines[1].get_color() == "red"
    assert plots.distribution(RETURNS[:, 0], colors="red").lines[0].get_color() == "red"

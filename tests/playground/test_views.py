"""What the pictures show: bars of action values, hatched states, the end of an episode, axes and labels."""

import math
from typing import Any

import numpy as np
import pytest

from support.playground import Playground

pytestmark = pytest.mark.browser

BARS = """() => [...document.querySelectorAll(".action-values tbody tr")].map((row) =>
  [row.className, parseFloat(row.querySelector(".bar").style.width)])"""
COLORS = """(cells) => {
  const { canvas, frame } = playground.view.values;
  const ratio = canvas.width / canvas.clientWidth;
  const image = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const colorAt = (x, y) => Array.from(image.data.slice(4 * (y * image.width + x), 4 * (y * image.width + x) + 3));
  return cells.map((cell) => {
    const { x, y, width } = frame.cell(cell);
    const [left, row] = [x + 0.2 * width, y + 0.8 * width].map((place) => Math.round(place * ratio));
    return Array.from({ length: Math.round(0.6 * width * ratio) }, (_, at) => colorAt(left + at, row));
  });
}"""
"""The red, green and blue along a line below the middle of each cell."""


@pytest.mark.parametrize("fragment", ["#env=CliffWalking-v1&example=0", "#env=FrozenLake-v1&example=1"])
def test_the_greedy_action_has_the_longest_bar(playground: Playground, fragment: str) -> None:
    playground.open(fragment)
    values = playground.page.evaluate("() => Array.from(playground.view.result.inspection.actionValues)")
    bars = playground.page.evaluate(BARS)
    lowest, highest = min(values), max(values)
    for value, (kind, width) in zip(values, bars, strict=True):
        assert width == pytest.approx(100 * (value - lowest) / (highest - lowest), abs=0.01)
        assert (kind == "greedy") == (width == 100)


def test_equal_values_have_no_bars(playground: Playground) -> None:
    playground.open("#env=FrozenLake-v1&example=0")
    assert {width for _, width in playground.page.evaluate(BARS)} == {0}


def test_states_that_were_never_visited_are_hatched(playground: Playground) -> None:
    playground.open("#env=FrozenLake8x8-v1%20(not%20slippery)&example=0")
    visits = playground.result()["visits"]
    assert visits[0] > 0
    assert visits[20] == 0
    visited, unvisited = playground.page.evaluate(COLORS, [0, 20])
    assert not any(_is_grey(color) for color in visited)
    assert all(_is_grey(color) for color in unvisited), "a color of the scale of values"
    assert len({tuple(color) for color in unvisited}) > 1, "no lines"
    assert "never visited" in playground.text("values-legend")


def _is_grey(color: list[int]) -> bool:
    return max(color) - min(color) < 40


@pytest.mark.parametrize(
    ("fragment", "end"),
    [
        ("#env=FrozenLake-v1&example=1", "it fell into a hole."),
        ("#env=CliffWalking-v1&example=0", "it reached the goal."),
        ("#env=MountainCar-v0&example=2", "it reached the flag."),
        ("#env=CartPole-v1&example=0", "the pole fell."),
        ("#env=CartPole-v1&example=2&seed=0", "time is up."),
        ("#env=Taxi-v4&example=1", "the passenger arrived."),
        ("#env=Acrobot-v1&example=0", "the end rose above the line."),
    ],
)
def test_the_end_of_an_episode_is_said_in_words(playground: Playground, fragment: str, end: str) -> None:
    playground.open(fragment)
    assert playground.text("motion-caption").endswith(f": {end}")


@pytest.mark.parametrize(
    ("grid", "warning"),
    [
        ("layout=S..W./...W./...WG", "Walls cut the goal off from the start: "),
        ("layout=SW.S/.W.G", "Walls cut the goal off from some starts: "),
        ("layout=S..G/....&wind=0,1,1,0", ""),
        ("layout=.../S.G&wind=1,1,1", "Walls or wind cut the goal off from the start: "),
        ("layout=S..", "There is no goal: every episode lasts until time is up."),
    ],
)
def test_a_goal_that_cannot_be_reached_is_noticed(playground: Playground, grid: str, warning: str) -> None:
    playground.open(f"#env=grid&{grid}&episodes=40&max_episode_steps=50")
    shown = playground.page.locator("#painter .warning")
    assert shown.is_visible() == bool(warning)
    assert shown.inner_text().startswith(warning)
    reached = any(length < 50 for length in playground.result()["lengths"])
    assert reached or warning, "an agent that explores finds a goal that it can reach"
    if "some" not in warning:
        assert not (reached and warning)


def test_a_curve_of_few_episodes_has_an_axis_for_them(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=0")
    ends: list[Any] = [playground.page.evaluate("() => playground.view.curve.shown.end")]
    playground.page.locator("#reset").click()
    for _ in range(4):
        playground.page.locator("#one-episode").click()
        playground.settled()
        ends.append(playground.page.evaluate("() => playground.view.curve.shown.end"))
    assert ends == [500, 1, 2, 3, 5]


def test_the_key_names_the_lines_to_compare_with_and_their_returns(playground: Playground) -> None:
    threshold, greatest, best = "threshold of a solved task: ", "greatest expected return: ", "best known return: "
    for fragment, expected in (
        ("MountainCar-v0&episodes=20", [f"{threshold}−110", f"{best}−97.67"]),
        ("FrozenLake-v1&episodes=20", [f"{threshold}0.7", f"{greatest}0.7442"]),
        ("CliffWalking-v1&episodes=20", [f"{greatest}−13"]),
        ("FrozenLake-v1&episodes=20&max_episode_steps=1", [f"{greatest}0"]),
    ):
        playground.open(f"#env={fragment}")
        key = playground.page.locator("#curve-key li").all_inner_texts()
        assert [text for text in key if ": " in text] == expected
    playground.page.locator('[data-measure="lengths"]').click()
    assert not any(": " in text for text in playground.page.locator("#curve-key li").all_inner_texts())


def test_the_end_of_a_game_follows_from_its_hand_and_its_return(playground: Playground) -> None:
    playground.open("#env=Blackjack-v1&episodes=3000")
    ends = set()
    for seed in range(20):
        playground.page.evaluate("seed => playground.store.update({ seed })", seed)
        playground.settled()
        total, earned = playground.page.evaluate(
            "() => { const { observations, return: earned } = playground.view.episode;"
            " return [Math.floor(observations.at(-1) / 22), earned]; }"
        )
        end = "it went over 21" if total > 21 else {1: "it won", 0: "a draw", -1: "the dealer won"}[earned]
        assert playground.text("motion-caption").endswith(f": {end}.")
        ends.add(end)
    assert len(ends) >= 3


@pytest.mark.parametrize(
    ("environment", "words"),
    [
        (
            "Taxi-v4",
            {0: "The taxi is in row 0, column 0, before the pick-up:", 5: "No state.", 54: "with the passenger"},
        ),
        (
            "Blackjack-v1",
            {
                0: "Sum 21, without a usable ace, the dealer shows A:",
                10: "No state.",
                11: "Sum 21, with a usable ace, the dealer shows A:",
                30: "Sum 20, without a usable ace, the dealer shows 10:",
                377: "No state.",
            },
        ),
    ],
)
def test_the_states_of_a_game_are_said_in_words(
    playground: Playground, environment: str, words: dict[int, str]
) -> None:
    playground.open(f"#env={environment}&episodes=300")
    for cell, text in words.items():
        assert text in playground.page.evaluate("cell => playground.view.describe(cell)", cell), cell


@pytest.mark.parametrize(
    ("fragment", "cell", "words"),
    [
        ("#env=grid&layout=S.W.G&episodes=20", 2, "Row 0, column 2: wall."),
        ("#env=Taxi-v4&episodes=50", 5, "No state."),
        ("#env=Blackjack-v1&episodes=50", 10, "No state."),
    ],
)
def test_a_cell_without_numbers_is_not_selected(playground: Playground, fragment: str, cell: int, words: str) -> None:
    playground.open(fragment)
    before = playground.text("inspection")
    playground.page.evaluate("cell => playground.view.pick(cell, 'press')", cell)
    playground.page.wait_for_function("words => document.querySelector('#live').textContent === words", arg=words)
    playground.settled()
    assert playground.text("inspection") == before
    assert playground.page.locator("#problem").is_hidden()


@pytest.mark.parametrize(
    ("fragment", "cell", "title"),
    [
        ("#env=CliffWalking-v1&episodes=20", 25, "State 25: row 2, column 1"),
        ("#env=Blackjack-v1&episodes=300", 0, "State 464: sum 21, without a usable ace, the dealer shows A"),
    ],
)
def test_a_state_has_the_number_that_it_has_in_python(
    playground: Playground, fragment: str, cell: int, title: str
) -> None:
    playground.open(fragment)
    playground.page.evaluate("cell => playground.view.pick(cell, 'press')", cell)
    playground.settled()
    assert playground.text("inspector-title") == title


def test_a_map_of_angles_shows_the_whole_circle(playground: Playground) -> None:
    playground.open("#env=Acrobot-v1&episodes=100")
    shown = playground.page.evaluate(
        """() => {
          const { values, motion } = playground.view;
          const { path, map } = values.content;
          const [observations, cells] = ["observations", "cells"].map((name) => Array.from(motion.episode[name]));
          const [edges, label] = [[map.xEdges[0], map.xEdges.at(-1)], motion.canvas.getAttribute("aria-label")];
          return { path, edges, observations, cells, label };
        }"""
    )
    assert shown["edges"] == [-math.pi, math.pi]
    observations = np.reshape(shown["observations"], (-1, 6))
    places = [place for place in shown["path"] if place is not None]
    angles = [np.arctan2(observations[:, sine], observations[:, sine - 1]) for sine in (1, 3)]
    np.testing.assert_allclose(places, np.transpose(angles), atol=1e-6)
    # A line across the map would join the two ends of a circle.
    turns = (np.abs(np.diff(places, axis=0)) > math.pi).any(axis=1).sum()
    assert turns > 0
    assert shown["path"].count(None) == turns
    cell = np.floor((np.array(places[0]) + math.pi) / (2 * math.pi) * 48).astype(int)
    assert shown["cells"][0] == (47 - cell[1]) * 48 + cell[0]
    cosine, sine, cosine2, sine2 = observations[0, :4]
    height = -cosine - (cosine * cosine2 - sine * sine2)
    assert shown["label"] == f"The agent: the end of the links is at height {height:.2f}, the line at 1."


def test_the_state_of_two_links_is_said_by_its_angles(playground: Playground) -> None:
    playground.open("#env=Acrobot-v1&episodes=20")
    playground.page.evaluate("() => playground.view.pick(24 * 48 + 36, 'press')")
    playground.settled()
    state = "θ1 1.64 rad, θ2 −0.0654 rad, angular velocity of θ1 0 rad/s, angular velocity of θ2 0 rad/s"
    assert playground.text("inspector-title") == f"State: {state}"

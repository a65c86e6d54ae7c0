"""Pictures of tabulated environments: their states on maps, with readable ticks, and the names of actions."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.environments.errand import SETTINGS, Errand, ErrandClass
from support.environments.own import Cliff, WindyGrid

plt = pytest.importorskip("matplotlib.pyplot")
from qtab.plots.arrangements.tuples import components, tuples  # noqa: E402 - after the check for matplotlib


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    plt.close("all")


def trained(env: gym.Env[Any, Any], **settings: Any) -> tuple[qtab.TabulatedEnv, qtab.Run]:
    table = qtab.tabulate(gym.wrappers.TimeLimit(env, 200))
    return table, qtab.train(table, seed=0, episodes=300, **settings)


def ticks(axis: Any) -> list[str]:
    return [tick.get_text() for tick in axis.get_ticklabels()]


def check_no_overlap(ax: Any) -> None:
    """No label of a tick overlaps the next one."""
    ax.figure.canvas.draw()
    boxes = [label.get_window_extent() for label in ax.get_xticklabels()]
    assert boxes
    assert not any(one.overlaps(other) for one, other in pairwise(boxes))


def test_pairs_are_the_rows_and_the_columns_of_a_map() -> None:
    table, run = trained(WindyGrid())
    ax = qtab.plots.values(run)
    assert (ax.get_ylabel(), ax.get_xlabel()) == ("state[0]", "state[1]")
    assert (ticks(ax.yaxis), ticks(ax.xaxis)) == ([*"0123456"], [*"0123456789"])
    assert ax.get_ylim() == (7.0, 0.0)
    values: Any = [mesh.get_array() for mesh in ax.collections if type(mesh).__name__ == "QuadMesh"][-1]
    expected = np.full((7, 10), np.nan)
    for number, (row, column) in enumerate(table.states):
        expected[row, column] = run.q_table[number].max()
    assert np.array_equal(np.ma.getdata(values)[~np.isnan(expected)], expected[~np.isnan(expected)])
    check_no_overlap(ax)


def test_each_value_of_another_component_has_a_map_with_its_title() -> None:
    _, run = trained(Errand(), **SETTINGS)
    ax = qtab.plots.values(run)
    titles = [text.get_text() for text in ax.texts if "=" in text.get_text()]
    assert titles == ["state[2] = 0", "state[2] = 1"]
    check_no_overlap(ax)


def test_named_rows_and_columns_show_moves_as_arrows() -> None:
    _, run = trained(ErrandClass(), **SETTINGS)
    ax = qtab.plots.policy(run, action_names=["up", "right", "down", "left"])
    arrows: list[Any] = [one for one in ax.collections if type(one).__name__ == "Quiver"]
    assert sum(len(one.U) for one in arrows) == (run.tables[0] != 0).any(axis=1).sum()
    assert (ax.get_ylabel(), ax.get_xlabel()) == ("row", "column")


def test_moves_on_unnamed_components_are_colors_with_the_given_names() -> None:
    _, run = trained(Errand(), **SETTINGS)
    ax = qtab.plots.policy(run, action_names=["up", "right", "down", "left"])
    legend = ax.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["up", "right", "down", "left"]
    assert not [one for one in ax.collections if type(one).__name__ == "Quiver"]


def test_numbered_states_are_in_order_with_ticks_that_fit() -> None:
    table, run = trained(Cliff())
    assert table.state_names[0] != "0"
    ax = qtab.plots.values(run)
    shown = ticks(ax.xaxis)
    assert shown == sorted(shown, key=int)
    assert 5 < len(shown) < len(table.states)
    check_no_overlap(ax)


def test_states_without_components_have_as_many_labels_as_fit() -> None:
    names = [f"a place with the long name number {number}" for number in range(108)]
    move = {number: {0: [(1.0, min(number + 1, 107), -1.0, number >= 106)]} for number in range(108)}
    table = qtab.TabulatedEnv(move, [1.0] + [0.0] * 107, state_names=names)
    ax = qtab.plots.values(qtab.train(table, seed=0, episodes=20, max_episode_steps=200))
    shown = ticks(ax.xaxis)
    assert 5 < len(shown) <= 24
    assert all(len(name) <= 28 for name in shown)
    check_no_overlap(ax)


def test_the_optimum_and_the_difference_have_the_same_arrangement() -> None:
    table, run = trained(ErrandClass(), **SETTINGS)
    best = qtab.optimum(table)
    for ax in (qtab.plots.values(best), qtab.plots.difference(run, best), qtab.plots.trajectory(run, env=table)):
        assert (ax.get_ylabel(), ax.get_xlabel()) == ("row", "column")


@pytest.mark.parametrize(
    ("names", "found"),
    [
        (["(0, 1)", "(1, 1)"], {"state[0]": (0, 1)}),
        (["((0, 2), [5])", "((1, 3), [5])"], {"state[0][0]": (0, 1), "state[0][1]": (2, 3)}),
        (["{'row': 2, 'at': (1, 2)}", "{'row': 1, 'at': (1, 3)}"], {"row": (1, 2), "at[1]": (2, 3)}),
        (["Motion(x=1.5, y=True)", "Motion(x=-1.5, y=False)"], {"x": (-1.5, 1.5), "y": (False, True)}),
        (["3", "-1"], {"state": (-1, 3)}),
        (["{'row': 3, 'seen': {0, 3}}", "{'row': 3, 'seen': set()}"], {"seen": ((), (0, 3))}),
        (["S(seen=frozenset({3, 0}))", "S(seen=frozenset({10}))", "S(seen={2})"], {"seen": ((0, 3), (2,), (10,))}),
        (["({[1]}, 1)", "({[1]}, 2)"], {}),
        (["-" * 100_000 + "1", "1"], {}),
        (["(" * 100_000 + ")" * 100_000, "1"], {}),
        (["(0,)", "(0, 1)"], {}),
        (["no", "yes"], {}),
        (["print()", "(1, 2"], {}),
    ],
)
def test_the_components_of_states_are_read_from_their_names(names: list[str], found: dict[str, Any]) -> None:
    assert {one.name: one.values for one in components(names)} == found


def test_a_set_is_written_as_python_does() -> None:
    [seen] = components(["{'row': 3, 'seen': {0, 3}}", "{'row': 3, 'seen': {2}}"])
    assert seen.ticks == ["{0, 3}", "{2}"]


def test_maps_that_would_be_mostly_empty_are_not_drawn() -> None:
    assert tuples([f"({number}, {number})" for number in range(20)]) is None
    assert tuples([f"({number}, {number % 4})" for number in range(20)]) is not None


def test_action_names_of_a_registered_environment_are_shown() -> None:
    made: Any = _Named
    gym.register("Named-v0", made, max_episode_steps=50)
    try:
        ax = qtab.plots.policy(qtab.train("Named-v0", seed=0, episodes=5))
        legend = ax.get_legend()
        assert legend is not None
        assert [text.get_text() for text in legend.get_texts()] == ["row back", "row on"]
    finally:
        del gym.registry["Named-v0"]


def test_an_environment_that_cannot_be_made_again_has_the_known_names() -> None:
    fails: list[Exception] = []

    def make() -> gym.Env[Any, Any]:
        if fails:
            raise fails[0]
        return _Named()

    entry: Any = make
    gym.register("Named-v0", entry, max_episode_steps=50)
    try:
        run = qtab.train("Named-v0", seed=0, episodes=5)
        for error in (FileNotFoundError("map.txt"), TypeError("no arguments")):
            fails[:] = [error]
            legend: Any = qtab.plots.policy(run).get_legend()
            assert [text.get_text() for text in legend.get_texts()] == list(run.action_names)
    finally:
        del gym.registry["Named-v0"]


def test_given_action_names_make_no_environment() -> None:
    made = list[gym.Env[Any, Any]]()

    def make() -> gym.Env[Any, Any]:
        made.append(_Named())
        return made[-1]

    entry: Any = make
    gym.register("Named-v0", entry, max_episode_steps=50)
    try:
        run = qtab.train("Named-v0", seed=0, episodes=5)
        before = len(made)
        legend: Any = qtab.plots.policy(run, action_names=("back", "on")).get_legend()
        assert len(made) == before
        assert [text.get_text() for text in legend.get_texts()] == ["back", "on"]
    finally:
        del gym.registry["Named-v0"]


class _Named(gym.Env[Any, Any]):
    """Two components, and names for the actions."""

    observation_space = gym.spaces.MultiDiscrete([3, 4])
    action_space = gym.spaces.Discrete(2)
    action_names = ("row back", "row on")

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.place = np.array([0, 0])
        return self.place.copy(), {}

    def step(self, action: int) -> Any:
        self.place = np.minimum(self.place + np.array([action, 1]), [2, 3])
        return self.place.copy(), -1.0, bool(self.place[1] == 3), False, {}

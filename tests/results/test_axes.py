"""Names of observations and actions, the edges of cells, and values in batches."""

import dataclasses
import warnings
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.config.origin import copied
from qtab.discretizers import Discretizer
from qtab.discretizers.identity import Identity
from qtab.envs.metadata.quantities import QUANTITIES, UNKNOWN, quantities_of
from qtab.envs.registry import ENTRIES, EXTRA
from qtab.results.axes import run_quantities

IDS = [*ENTRIES, *EXTRA]


@pytest.mark.parametrize("env", IDS)
def test_every_environment_is_described_as_its_spaces_are(env: str) -> None:
    described = quantities_of(env)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # an old version of CartPole
        made = gym.make(env)
    space: Any = made.observation_space
    components = (
        1
        if isinstance(space, gym.spaces.Discrete)
        else len(space)
        if isinstance(space, gym.spaces.Tuple)
        else space.shape[0]
    )
    assert len(described.observation) == components
    assert (described.bounds is not None) == isinstance(space, gym.spaces.Box)
    if described.bounds is not None:
        assert np.array(described.bounds, space.dtype).tolist() == [space.low.tolist(), space.high.tolist()]
    actions: Any = made.action_space
    if isinstance(actions, gym.spaces.Discrete):
        assert len(described.actions) == (2 if "Bias" in env else actions.n)
    else:
        assert len(described.continuous_actions) == actions.shape[0]
    made.close()


def test_no_description_is_for_an_environment_that_does_not_exist() -> None:
    assert set(QUANTITIES) == set(IDS)


@pytest.mark.parametrize("env", ["MountainCar-v0", "qtab/MountainCar-v0"])
def test_a_run_names_its_axes_and_actions(env: str) -> None:
    run = qtab.train(env, episodes=1, seed=0)
    assert [axis.label for axis in run.axes] == ["position (m)", "velocity (m/step)"]
    assert run.action_names == ("push left", "no push", "push right")
    assert [len(axis.edges) for axis in run.axes] == [20, 16]


@pytest.mark.parametrize(
    ("env", "chosen", "names"),
    [
        ("Taxi-v4", {}, ("south", "north", "east", "west", "pick up", "drop off")),
        ("Blackjack-v1", {}, ("stick", "hit")),
        ("FrozenLake-v1", {}, ("left", "down", "right", "up")),
        ("Pendulum-v1", {"actions": (-2.0, 0.0, 2.0)}, ("torque -2 N m", "torque 0 N m", "torque 2 N m")),
        ("qtab/MaximizationBias-v0", {"env_kwargs": {"actions": 3}, "initial_q": 0.0}, ("right", "left", "action 2")),
    ],
)
def test_actions_have_gymnasiums_words(env: str, chosen: dict[str, Any], names: tuple[str, ...]) -> None:
    assert qtab.train(env, episodes=1, seed=0, **chosen).action_names == names


class Unknown(gym.Env[Any, Any]):
    """An environment with a box of three components and actions from 1 on."""

    def __init__(self) -> None:
        self.observation_space = gym.spaces.Box(-1, 1, (3,))
        self.action_space = gym.spaces.Discrete(2, start=1)

    def reset(self, **_: Any) -> Any:
        return np.zeros(3, np.float32), {}

    def step(self, action: Any) -> Any:
        return np.zeros(3, np.float32), 0.0, bool(action == 1), False, {}


def test_an_unknown_environment_has_neutral_names() -> None:
    run = qtab.train(Unknown(), discretizer="bins", bins=2, episodes=2, seed=0, max_episode_steps=5)
    assert [axis.name for axis in run.axes] == ["observation[0]", "observation[1]", "observation[2]"]
    assert run.action_names == ("action 1", "action 2")


@pytest.mark.parametrize(
    "chosen",
    [
        {"discretizer": "round", "scale": (10, 100)},
        {"discretizer": "bins", "bins": (5, 4)},
        {"discretizer": "edges", "edges": ((-0.5, 0.1), (0.0,))},
    ],
)
def test_the_middle_of_a_cell_is_in_the_cell(chosen: dict[str, Any]) -> None:
    run = qtab.train("MountainCar-v0", episodes=1, seed=0, **chosen)
    edges = [axis.edges for axis in run.axes]
    assert [len(row) - 1 for row in edges] == list(run.discretizer.shape)
    middles = [(row[1:] + row[:-1]) / 2 for row in edges]
    for cell in np.ndindex(*run.discretizer.shape):
        observation = np.array([row[index] for row, index in zip(middles, cell, strict=True)], np.float32)
        assert run.discretizer.cell(observation) == cell


def test_integers_lie_between_their_edges() -> None:
    discretizer: Discretizer = Identity(np.array([4, 0]), np.array([6, 1]))
    assert [edges.tolist() for edges in discretizer.cell_edges()] == [[3.5, 4.5, 5.5, 6.5], [-0.5, 0.5, 1.5]]


def test_bins_without_outer_edges_have_those_of_the_space() -> None:
    edges = ((0.0,), (0.0,), (-0.1, 0.1), (0.0,))
    run = qtab.train("CartPole-v1", discretizer="edges", edges=edges, episodes=1, seed=0)
    assert run.axes[1].edges.tolist() == [-np.inf, 0.0, np.inf]
    assert run.axes[2].edges[[1, 2]].tolist() == [-0.1, 0.1]


@pytest.mark.parametrize(
    "chosen", [{"preset": "article"}, {"preset": "solved"}, {"algorithm": "double_q_learning", "initial_q": 0.5}]
)
def test_values_are_the_largest_action_values(chosen: dict[str, Any]) -> None:
    run = qtab.train("MountainCar-v0", episodes=5, seed=0, **chosen)
    observations = np.array([[-0.5, 0.01], [0.3, -0.02], [-1.2, 0.0]], np.float32)
    values = run.values(observations)
    assert values.shape == (3,)
    assert values.tolist() == (run.q_values(observations).max(axis=1) / len(run.tables)).tolist()
    one = run.values(observations[1])
    assert isinstance(one, float)
    assert one == values[1]


class CliffWalking(gym.Env[Any, Any]):
    """An environment of a user's with the name of one of Gymnasium's, and other actions."""

    def __init__(self, **_: Any) -> None:
        self.observation_space = gym.spaces.Discrete(48)
        self.action_space = gym.spaces.Discrete(4)

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        return 0, {}

    def step(self, action: Any) -> Any:
        return 1, 0.0, bool(action == 1), False, {}


def test_a_class_of_the_same_name_has_neutral_names() -> None:
    run = qtab.train(CliffWalking(), episodes=2, seed=0, max_episode_steps=5)
    assert run.config.env == "CliffWalking"
    assert run.action_names == ("action 0", "action 1", "action 2", "action 3")
    assert qtab.explain(run, steps=1, env=CliffWalking())[0].action_name.startswith("action ")
    assert qtab.plots.policy(run).get_xlabel() == "state"  # not Gymnasium's map


def test_a_run_of_an_earlier_version_keeps_its_names() -> None:
    run = qtab.train("qtab/KArmedBandit-v0", episodes=1, seed=0)
    assert run.config.origin is not None
    assert run.config.origin.environment is not None
    earlier = dataclasses.replace(run.config.origin.environment, cls="qtab.envs.k_armed_bandit:KArmedBanditEnv")
    config = copied(run.config, dataclasses.replace(run.config.origin, environment=earlier))
    assert run_quantities(config, run.discretizer) == run_quantities(run.config, run.discretizer) != UNKNOWN


@pytest.mark.parametrize("version", ["CliffWalking-v7", "mine/CliffWalking-v1"])
def test_an_id_of_another_version_or_namespace_has_neutral_names(version: str) -> None:
    assert quantities_of(version) is UNKNOWN
    gym.register(version, CliffWalking)
    try:
        assert qtab.train(version, episodes=1, seed=0, max_episode_steps=5).action_names[0] == "action 0"
    finally:
        del gym.registry[version]


def test_another_environment_under_the_same_id_has_neutral_names() -> None:
    of_gymnasium = gym.registry["CliffWalking-v1"]
    assert (
        quantities_of("CliffWalking-v1") is quantities_of("somewhere:CliffWalking-v1") is QUANTITIES["CliffWalking-v1"]
    )
    try:
        with pytest.warns(UserWarning, match="Overriding environment"):
            gym.register("CliffWalking-v1", CliffWalking)
        assert quantities_of("CliffWalking-v1") is UNKNOWN
        assert qtab.train("CliffWalking-v1", episodes=1, seed=0, max_episode_steps=5).action_names[0] == "action 0"
        wrapped = gym.envs.registration.WrapperSpec("A", "gymnasium.wrappers:FlattenObservation", {})
        gym.registry["CliffWalking-v1"] = dataclasses.replace(of_gymnasium, additional_wrappers=(wrapped,))
        assert quantities_of("CliffWalking-v1") is UNKNOWN
    finally:
        gym.registry["CliffWalking-v1"] = of_gymnasium


def test_a_rescaled_position_has_no_unit() -> None:
    env = gym.wrappers.RescaleObservation(gym.make("MountainCar-v0"), np.float32(0.0), np.float32(1.0))
    run = qtab.train(env, discretizer="bins", bins=3, episodes=2, seed=0, max_episode_steps=9)
    assert [axis.label for axis in run.axes] == ["observation[0]", "observation[1]"]
    assert run.action_names == ("push left", "no push", "push right")
    ax = qtab.plots.values(run)
    assert (ax.get_xlabel(), [text.get_text() for text in ax.texts]) == ("observation[0]", [])  # no flag at 0.5
    assert qtab.explain(run, steps=1, env=env)[0].state.startswith("(0.")


WRAPPED: list[tuple[str, Any, tuple[bool, bool]]] = [
    ("Pendulum-v1", lambda env: gym.wrappers.TransformReward(env, lambda reward: float(reward) / 10), (True, True)),
    ("Pendulum-v1", lambda env: gym.wrappers.RescaleAction(env, np.float32(-1), np.float32(1)), (True, False)),
    ("Pendulum-v1", lambda env: gym.wrappers.DelayObservation(env, 1), (False, True)),
    ("Pendulum-v1", gym.Wrapper, (False, False)),
    ("FrozenLake-v1", lambda env: gym.wrappers.TransformObservation(env, lambda n: 15 - n, None), (False, True)),
    ("FrozenLake-v1", gym.wrappers.RecordEpisodeStatistics, (True, True)),
]
"""Wrappers that keep the bounds, and whether observations and actions are still named."""


@pytest.mark.parametrize(("env", "wrap", "named"), WRAPPED)
def test_only_what_no_wrapper_changes_is_named(env: str, wrap: Any, named: tuple[bool, bool], tmp_path: Any) -> None:
    chosen: Any = {"episodes": 1, "seed": 0, "max_episode_steps": 5}
    chosen |= {"actions": (-1.0, 0.0, 1.0)} if env == "Pendulum-v1" else {}
    run = qtab.train(wrap(gym.make(env)), **chosen)
    run.save(tmp_path / "run.npz")
    plain = qtab.train(env, **chosen)
    for found in (run, qtab.load(tmp_path / "run.npz")):
        if env == "Pendulum-v1":
            assert (found.axes[0].name == plain.axes[0].name) == named[0]
        else:
            assert (qtab.plots.values(found).get_xlabel() == "column") == named[0]  # Gymnasium's map
        assert (found.action_names == plain.action_names) == named[1]


@pytest.mark.parametrize("env", IDS)
def test_every_environment_of_the_registry_is_described_in_its_runs(env: str) -> None:
    run = qtab.train(env, episodes=1, seed=0, max_episode_steps=2)
    assert run_quantities(run.config, run.discretizer) is quantities_of(env)

"""Tables of ``qtab.tabulate`` in the rest of the package: many seeds, files, masks, time limits, pictures, vectors."""

import copy
import pickle
from pathlib import Path
from typing import Any

import gymnasium as gym
import matplotlib.pyplot as plt
import numpy as np
import pytest

import qtab


class Ferry(qtab.FunctionalEnv):
    """Six places: row one, or sail one or two, or back to the first. There is no sail at place 1."""

    observation_space = gym.spaces.Discrete(6)
    action_space = gym.spaces.Discrete(2)
    action_names = ("row", "sail")

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        if action == 0:
            state = state + 1
        else:
            state = 0 if rng.random() < 0.2 else state + rng.integers(1, 3)
        return min(state, 5), -1.0, state >= 5

    def observe(self, state: Any) -> Any:
        return state

    def action_mask(self, state: Any) -> Any:
        return np.array([1, state != 1], np.int8)


def ferry(steps: int = 20) -> qtab.TabulatedEnv:
    return qtab.tabulate(gym.wrappers.TimeLimit(Ferry(), steps))


@pytest.fixture(scope="module")
def table() -> qtab.TabulatedEnv:
    return ferry()


@pytest.fixture(scope="module")
def run(table: qtab.TabulatedEnv) -> qtab.Run:
    return qtab.train(table, episodes=200, seed=0, action_mask=True, visits=True)


def test_many_seeds_and_sweeps_train_the_table_that_a_function_returns(
    table: qtab.TabulatedEnv, run: qtab.Run, tmp_path: Path
) -> None:
    runs = qtab.train_many(lambda: table, seeds=3, episodes=200, action_mask=True, tables=True)
    assert runs[0].config.backend == "rust"
    assert runs[0].config.max_episode_steps == 20
    assert np.array_equal(runs[0].q_table, run.q_table)
    grid: Any = {"learning_rate": [0.1, 0.3]}
    settings: Any = {"episodes": 50, "action_mask": True, "store": tmp_path / "sweep.db"}
    qtab.sweep(lambda: table, grid, seeds=2, **settings)
    longer = qtab.sweep(lambda: table, grid, seeds=3, **settings)
    whole = qtab.sweep(ferry, grid, seeds=3, episodes=50, action_mask=True)
    assert np.array_equal(longer.mean_final_returns(), whole.mean_final_returns())


def test_a_run_is_resumed_to_the_numbers_of_a_whole_one(table: qtab.TabulatedEnv) -> None:
    half, whole = (
        qtab.train(table, episodes=episodes, seed=1, epsilon=0.2, action_mask=True) for episodes in (60, 120)
    )
    assert np.array_equal(qtab.resume(half, episodes=120, env=table).q_table, whole.q_table)


def test_a_loaded_run_is_evaluated_verified_and_explained(
    table: qtab.TabulatedEnv, run: qtab.Run, tmp_path: Path
) -> None:
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    ours, theirs = (qtab.evaluate(one, 50, seed=1, env=table) for one in (run, loaded))
    assert np.array_equal(ours.returns, theirs.returns)
    assert ours.lengths.max() <= 20
    assert qtab.verify(loaded, env=table).equal
    step = qtab.explain(loaded, episode=5, env=table)[0]
    assert step.state.startswith("state 0")
    assert step.action_name in Ferry.action_names


def test_unavailable_actions_are_never_taken_and_not_optimal(table: qtab.TabulatedEnv, run: qtab.Run) -> None:
    assert table.masks is not None
    visits: Any = run.visits
    assert not visits[~table.masks].any()
    assert visits[:5].any(axis=1).all()
    best = qtab.optimum(table)
    assert table.masks[np.arange(6), best.policy].all()
    assert run.predict(1)[0] == 0
    assert 0.0 <= best.expected_return - best.gap(run).greedy_return < 1.0


def test_a_run_that_counts_the_steps_keeps_the_time_limit_of_the_table() -> None:
    table = ferry(steps=4)
    run = qtab.train(table, episodes=300, seed=0, time_aware=True, action_mask=True)
    assert run.q_table.shape == (4, 6, 2)
    assert run.at_step(3).q_table.shape == (6, 2)
    assert qtab.evaluate(run, 50, seed=1, env=table).lengths.max() <= 4
    assert qtab.verify(run, env=table).equal


def test_pictures_have_the_states_and_actions_of_the_table(table: qtab.TabulatedEnv, run: qtab.Run) -> None:
    try:
        for ax in (
            qtab.plots.values(run),
            qtab.plots.policy(run),
            qtab.plots.visits(run),
            qtab.plots.trajectory(run, env=table),
            qtab.plots.values(qtab.optimum(table)),
        ):
            figure: Any = ax.figure
            figure.canvas.draw()
            assert ax.has_data()
    finally:
        plt.close("all")


@pytest.mark.parametrize(
    "copied",
    [copy.deepcopy, lambda table: pickle.loads(pickle.dumps(table))],  # noqa: S301
)
def test_copies_train_alike(copied: Any, table: qtab.TabulatedEnv, run: qtab.Run) -> None:
    other = copied(table)
    assert (other.states, other.state_names, other.max_episode_steps) == (table.states, table.state_names, 20)
    again = qtab.train(other, episodes=200, seed=0, action_mask=True)
    assert again.q_table.tobytes() == run.q_table.tobytes()


def test_an_environment_made_from_its_id_has_the_same_table(table: qtab.TabulatedEnv) -> None:
    gym.register("Ferry-v0", entry_point=lambda **kwargs: Ferry(**kwargs), max_episode_steps=20)
    try:
        made = qtab.tabulate(gym.make("Ferry-v0"))
    finally:
        del gym.registry["Ferry-v0"]
    assert (made.P, made.states, made.max_episode_steps) == (table.P, table.states, 20)


def test_a_table_whose_class_was_copied_is_stepped_in_rust() -> None:
    for env in (ferry(), qtab.TabularEnv(ferry().P, ferry().initial_state_distrib)):
        copy.deepcopy(env)
    assert "__slotnames__" in vars(qtab.TabulatedEnv)
    assert qtab.train(ferry(), episodes=2, seed=0).config.backend == "rust"


def test_a_registered_table_trains_by_its_id_and_steps_in_vectors(run: qtab.Run) -> None:
    gym.register("TabulatedFerry-v0", entry_point=lambda **_: ferry(), max_episode_steps=20)
    try:
        by_id = qtab.train("TabulatedFerry-v0", episodes=200, seed=0, action_mask=True)
        assert by_id.config.backend == "rust"
        assert np.array_equal(by_id.q_table, run.q_table)
        ours: Any = qtab.RustVectorEnv("TabulatedFerry-v0", 3)
        theirs: Any = gym.make_vec("TabulatedFerry-v0", num_envs=3)
        assert np.array_equal(ours.reset(seed=0)[0], theirs.reset(seed=0)[0])
        actions = np.random.default_rng(0).integers(2, size=(60, 3))
        for chosen in actions:
            for one, other in zip(ours.step(chosen)[:4], theirs.step(chosen)[:4], strict=True):
                assert np.array_equal(one, other)
        theirs.close()
    finally:
        del gym.registry["TabulatedFerry-v0"]

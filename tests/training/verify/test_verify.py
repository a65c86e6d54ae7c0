"""verify repeats a run in Gymnasium and NumPy, and reports the first difference."""

import dataclasses
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.environments import Walk
from support.parity import table_to_go_on_from

LEARNED = table_to_go_on_from()


def train(**settings):
    return qtab.train("MountainCar-v0", **{"seed": 3, "episodes": 12, "max_episode_steps": 60} | settings)


RUNS = {
    "default": {},
    "MT19937": {"bit_generator": "MT19937"},
    "gymnasium": {"backend": "gymnasium"},
    "MT19937 on gymnasium": {"bit_generator": "MT19937", "backend": "gymnasium"},
    "from a table, to the goal": {"initial_q": LEARNED, "max_episode_steps": 1000, "epsilon": 0.1},
    "the book's update": {"initial_q": LEARNED, "max_episode_steps": 1000, "terminal_update": "target"},
    "a long seed": {"seed": 2**200 + 1},
    "another goal": {"env_kwargs": {"goal_velocity": 0.05}},
}


@pytest.mark.parametrize("settings", RUNS.values(), ids=RUNS)
def test_a_run_verifies(settings):
    run = train(**settings)
    report = qtab.verify(run)
    assert run.terminated.any() == (run.config.max_episode_steps == 1000)
    assert report.equal is True
    assert (report.returns_equal, report.lengths_equal, report.table_equal) == (True, True, True)
    assert (report.episode, report.step) == (None, None)
    assert report.episodes == 12
    assert report.seed == run.config.seed
    assert {"gymnasium", "numpy", "python", "platform"} <= set(report.versions)


@pytest.mark.parametrize("env", ["qtab/MountainCar-v0", "qtab:qtab/MountainCar-v0", gym.spec("MountainCar-v0")])
def test_runs_of_our_ids_and_of_specs_verify(env):
    assert qtab.verify(qtab.train(env, seed=0, episodes=3)).equal


def test_a_saved_run_verifies(tmp_path):
    train().save(tmp_path / "run.npz")
    assert qtab.verify(qtab.load(tmp_path / "run.npz")).equal


@pytest.mark.parametrize("bit_generator", ["PCG64", "MT19937"])
@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
@pytest.mark.parametrize("episodes", [1, 5, 12])
def test_a_prefix_verifies_with_the_schedule_of_the_full_run(bit_generator, backend, episodes):
    report = qtab.verify(train(bit_generator=bit_generator, backend=backend), episodes=episodes)
    assert report.equal is True
    assert report.episodes == episodes


def test_a_prefix_of_the_articles_five_thousand_episodes_verifies():
    assert qtab.verify(qtab.train("MountainCar-v0", seed=0), episodes=30).equal


def stopped():
    return train(callback=lambda progress: progress.episodes < 6, callback_every=3)


def test_a_stopped_run_verifies_on_a_prefix():
    assert qtab.verify(stopped(), episodes=6).equal
    assert qtab.verify(stopped(), episodes=4).equal


def test_a_stopped_run_is_refused_without_a_prefix():
    with pytest.raises(ValueError, match="episodes must be given for a run that was stopped early, at most 6"):
        qtab.verify(stopped())


@pytest.mark.parametrize(("episodes", "error"), [(0, ValueError), (13, ValueError), (2.0, TypeError), ("5", TypeError)])
def test_a_number_of_episodes_that_does_not_fit_is_refused(episodes, error):
    with pytest.raises(error, match=rf"episodes must be an integer from 1 to 12, got {episodes!r}"):
        qtab.verify(train(), episodes=episodes)


def tampered(run, name, index, change):
    values = getattr(run, name).copy()
    values.flat[index] = change(values.flat[index])
    return dataclasses.replace(run, **{name: values})


def test_a_changed_return_is_reported_with_its_episode():
    report = qtab.verify(tampered(train(), "episode_returns", 4, lambda value: np.nextafter(value, 0)))
    assert report.equal is False
    assert (report.returns_equal, report.lengths_equal, report.table_equal) == (False, True, True)
    assert (report.episode, report.step) == (4, None)


@pytest.mark.parametrize(("change", "step"), [(-20, 40), (+3, 60)])
def test_a_changed_length_is_reported_with_its_episode_and_step(change, step):
    report = qtab.verify(tampered(train(), "episode_lengths", 7, lambda value: value + change))
    assert (report.returns_equal, report.lengths_equal, report.table_equal) == (True, False, True)
    assert (report.episode, report.step) == (7, step)


@pytest.mark.parametrize("cell", [0, 400, -1])
def test_a_table_that_differs_by_one_bit_is_reported(cell):
    run = tampered(train(), "tables", cell, lambda value: np.nextafter(value, 9))
    report = qtab.verify(run)
    assert report.equal is False
    assert (report.returns_equal, report.lengths_equal, report.table_equal) == (True, True, False)
    assert (report.episode, report.step) == (None, None)


def test_the_table_of_a_run_is_compared_whenever_all_its_episodes_are():
    run = train()
    shifted = dataclasses.replace(run, tables=run.tables + 1)
    for episodes in (None, 12):
        report = qtab.verify(shifted, episodes=episodes)
        assert (report.equal, report.table_equal, report.table_of_run) == (False, False, True)
        assert "Q table  DIFFERENT\n" in str(report)
    part = qtab.verify(shifted, episodes=11)
    assert (part.equal, part.table_of_run) == (True, False)
    sentence = "from training again in Rust: the run holds none after 11 episodes"
    assert sentence in str(part)
    assert sentence in part._repr_html_()
    assert sentence not in str(qtab.verify(run))
    assert qtab.verify(run, episodes=12).equal


def test_the_table_of_a_stopped_run_is_compared_unless_an_unfinished_episode_changed_it():
    assert qtab.verify(stopped(), episodes=6).table_of_run
    assert not qtab.verify(stopped(), episodes=5).table_of_run
    changed = dataclasses.replace(stopped(), tables=stopped().tables + 1)
    assert not qtab.verify(changed, episodes=6).table_of_run


def test_the_sign_of_a_zero_is_a_difference():
    run = train(initial_q=(0.0, 0.0))
    untouched = int(np.flatnonzero(run.tables == 0.0)[0])
    assert qtab.verify(run).equal
    assert not qtab.verify(tampered(run, "tables", untouched, lambda value: -0.0)).equal


def test_tables_are_compared_in_any_memory_order():
    run = train()
    flipped = np.asfortranarray(run.tables)
    assert qtab.verify(dataclasses.replace(run, tables=flipped)).equal


@pytest.mark.parametrize("episodes", [None, 5])
def test_a_changed_seed_is_reported_with_the_first_episode_that_differs(episodes):
    run = train(initial_q=LEARNED, max_episode_steps=1000, episodes=6)
    other = train(initial_q=LEARNED, max_episode_steps=1000, episodes=6, seed=4)
    claimed = dataclasses.replace(run, config=run.config.replace(seed=4))
    report = qtab.verify(claimed, episodes=episodes)
    assert report.equal is False
    assert report.episode == int(np.argmax(run.episode_lengths != other.episode_lengths))


@pytest.mark.parametrize("setting", [{"learning_rate": 0.21}, {"discount": 0.91}, {"terminal_update": "target"}])
def test_a_changed_setting_is_reported(setting):
    run = train(initial_q=LEARNED, max_episode_steps=1000, epsilon=0.1, episodes=4)
    assert run.terminated.any()
    assert not qtab.verify(dataclasses.replace(run, config=run.config.replace(**setting))).equal


def test_a_run_on_an_object_verifies_against_that_object():
    run = qtab.train(Walk(start=5), scale=(2, 2), seed=0, episodes=5, max_episode_steps=40)
    assert qtab.verify(run, env=Walk(start=5)).equal
    assert qtab.verify(run, env=Walk(start=5), episodes=3).equal
    assert qtab.verify(tampered(run, "episode_lengths", 2, lambda value: value + 1), env=Walk(start=5)).episode == 2


def test_an_edited_object_verifies_only_against_itself():
    env: Any = gym.make("MountainCar-v0")
    env.unwrapped.force = 0.002
    run = qtab.train(env, seed=0, episodes=10)
    assert qtab.verify(run, env=env).equal
    assert qtab.verify(run).equal  # in an environment that was made again
    with pytest.raises(ValueError, match=r"its attribute force was 0\.002, and is now 0\.001"):
        qtab.verify(run, env=gym.make("MountainCar-v0"))


def test_progress_is_reported_after_every_episode():
    told = []
    qtab.verify(train(episodes=4), progress=lambda done, total: told.append((done, total)))
    assert [total for _, total in told] == [4] * len(told)
    assert [done for done, _ in told] == [1, 2, 3, 4]


def test_a_verification_prints_a_readable_report():
    run = tampered(train(), "episode_lengths", 7, lambda value: value - 1)
    text = str(qtab.verify(run))
    assert "MountainCar-v0, seed 3, 12 episodes" in text
    assert "returns  equal" in text
    assert "lengths  DIFFERENT" in text
    assert "they differ from episode 7, step 59 on" in text
    assert f"numpy {np.__version__}" in text


def test_a_difference_of_a_run_from_another_machine_names_the_machine():
    run = qtab.train("MountainCar-v0", seed=0, episodes=3)
    versions = {**run.versions, "platform": "Linux aarch64 musl 1.2"}
    other = dataclasses.replace(run, versions=versions, episode_returns=run.episode_returns - 1)
    verification = qtab.verify(other)
    assert verification.trained_with == {"platform": "Linux aarch64 musl 1.2"}
    assert "the run was trained with platform Linux aarch64 musl 1.2: other libraries" in str(verification)
    assert "trained with" in verification._repr_html_()
    assert qtab.verify(dataclasses.replace(run, versions=versions)).trained_with is None
    same = qtab.verify(dataclasses.replace(run, episode_returns=run.episode_returns - 1))
    assert same.trained_with == {}
    assert "trained with" not in str(same)

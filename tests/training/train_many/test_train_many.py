"""Many runs: each equals the single run of its seed, for any number of threads."""

import importlib
import sys
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from support.parity import assert_same_as_single_runs, run_of

CAR = "MountainCar-v0"
POLE = "CartPole-v1"
LAKE = "FrozenLake-v1"
CLIFF = "CliffWalking-v1"
SHORT: dict[str, Any] = {"episodes": 30}
ONE_STEP: dict[str, st.SearchStrategy[Any]] = {
    "algorithm": st.sampled_from(["q_learning", "sarsa", "expected_sarsa"]),
    "learning_rate": st.floats(0, 1),
    "learning_rate_schedule": st.sampled_from(["constant", "linear"]),
    "discount": st.floats(0, 1),
    "epsilon": st.floats(0, 1),
    "epsilon_schedule": st.sampled_from(["constant", "linear"]),
}
"""The settings of learners that train in batches."""


@pytest.mark.parametrize("threads", [1, 2, 7, 64])
def test_each_run_equals_the_single_run_for_any_number_of_threads(threads):
    runs = qtab.train_many(CAR, seeds=range(20), threads=threads, tables=True, episodes=200)
    assert runs.completed
    assert runs.seeds == tuple(range(20))
    assert runs.episode_returns.shape == runs.episode_lengths.shape == runs.terminated.shape == (20, 200)
    assert runs.tables is not None
    assert runs.tables.shape == (20, 1, 285, 3)
    assert_same_as_single_runs(runs, episodes=200)


@settings(max_examples=15, deadline=None)
@given(
    seeds=st.lists(st.integers(0, 2**32 - 1), min_size=1, max_size=12, unique=True),
    threads=st.integers(1, 5),
    episodes=st.integers(1, 25),
    config=st.fixed_dictionaries(
        {
            "learning_rate": st.floats(0, 1),
            "discount": st.floats(0, 1),
            "epsilon": st.floats(0.1, 1),
            "epsilon_schedule": st.sampled_from(["constant", "linear"]),
            "bit_generator": st.sampled_from(["PCG64", "MT19937"]),
            "terminal_update": st.sampled_from(["assign", "target"]),
            "max_episode_steps": st.sampled_from([1, 37, 200, 500]),
        }
    ),
)
def test_each_run_equals_the_single_run_for_any_config(seeds, threads, episodes, config):
    runs = qtab.train_many(CAR, seeds, threads=threads, tables=True, episodes=episodes, **config)
    assert_same_as_single_runs(runs, episodes=episodes, **config)


@settings(max_examples=15, deadline=None)
@given(
    seeds=st.lists(st.integers(0, 2**32 - 1), min_size=4, max_size=12, unique=True),
    episodes=st.integers(2, 25),
    config=st.fixed_dictionaries(
        {
            "learning_rate": st.floats(0.1, 1),
            "learning_rate_schedule": st.sampled_from(["constant", "linear"]),
            "discount": st.floats(0, 1),
            "epsilon": st.floats(0.1, 1),
            "epsilon_schedule": st.sampled_from(["constant", "linear"]),
            "terminal_update": st.sampled_from(["assign", "target"]),
            "max_episode_steps": st.sampled_from([1, 37, 500]),
            "bins": st.sampled_from([(3, 3, 6, 6), (1, 1, 9, 70)]),
            "env_kwargs": st.sampled_from([{}, {"sutton_barto_reward": True}]),
        }
    ),
)
def test_each_run_of_cart_pole_equals_the_single_run_for_any_config(seeds, episodes, config):
    runs = qtab.train_many(POLE, seeds, threads=1, tables=True, episodes=episodes, **config)
    assert_same_as_single_runs(runs, env=POLE, episodes=episodes, **config)


def test_runs_of_cart_pole_equal_gymnasiums():
    runs = qtab.train_many(POLE, 9, threads=1, tables=True, episodes=40)
    assert runs.config.backend == "rust"
    assert_same_as_single_runs(runs, env=POLE, episodes=40, backend="gymnasium")


@settings(max_examples=15, deadline=None)
@given(
    env=st.sampled_from([CAR, POLE]),
    seeds=st.lists(st.integers(0, 2**32 - 1), min_size=4, max_size=12, unique=True),
    episodes=st.integers(1, 12),
    config=st.fixed_dictionaries(
        {
            **ONE_STEP,
            "tilings": st.sampled_from([8, 16, 32]),
            "tiles": st.integers(1, 6),
            "hashed_rows": st.sampled_from([None, 64]),
            "max_episode_steps": st.sampled_from([1, 37, 200]),
        }
    ),
)
def test_each_run_with_tilings_equals_the_single_run_for_any_config(env, seeds, episodes, config):
    config = {**config, "discretizer": "tiles"}
    runs = qtab.train_many(env, seeds, threads=1, tables=True, episodes=episodes, **config)
    assert_same_as_single_runs(runs, env=env, episodes=episodes, **config)


@settings(max_examples=15, deadline=None)
@given(
    env=st.sampled_from([LAKE, CLIFF]),
    seeds=st.lists(st.integers(0, 2**32 - 1), min_size=4, max_size=12, unique=True),
    episodes=st.integers(1, 60),
    config=st.fixed_dictionaries(
        {
            **ONE_STEP,
            "terminal_update": st.sampled_from(["assign", "target"]),
            "max_episode_steps": st.sampled_from([1, 37, 200]),
            "env_kwargs": st.sampled_from([{"is_slippery": True}, {"is_slippery": False}]),
        }
    ),
)
def test_each_run_on_a_table_equals_the_single_run_for_any_config(env, seeds, episodes, config):
    runs = qtab.train_many(env, seeds, threads=1, tables=True, episodes=episodes, **config)
    assert_same_as_single_runs(runs, env=env, episodes=episodes, **config)


@pytest.mark.parametrize("algorithm", ["q_learning", "sarsa", "expected_sarsa"])
@pytest.mark.parametrize(
    ("env", "config"),
    [
        (LAKE, {"episodes": 100}),
        (CAR, {"episodes": 20}),
        (CAR, {"episodes": 6, "discretizer": "tiles", "tilings": 8}),
        (POLE, {"episodes": 20, "discretizer": "tiles", "tilings": 8}),
        (POLE, {"episodes": 10, "discretizer": "tiles", "tilings": 16}),
        (CAR, {"episodes": 3, "discretizer": "tiles", "tilings": 32}),
    ],
)
def test_runs_of_a_batch_equal_gymnasiums(algorithm, env, config):
    config = {**config, "algorithm": algorithm}
    runs = qtab.train_many(env, 8, threads=1, tables=True, **config)
    assert runs.config.backend == "rust"
    assert_same_as_single_runs(runs, env=env, **config, backend="gymnasium")


TWO_TABLES: dict[str, Any] = {"algorithm": "double_q_learning"}
TILES: dict[str, Any] = {"discretizer": "tiles", "algorithm": "sarsa"}


@pytest.mark.parametrize(
    ("config", "backend"),
    [
        (TWO_TABLES, "rust"),
        ({"algorithm": "sarsa_lambda", "trace_decay": 0.9}, "rust"),
        ({"algorithm": "dyna_q", "planning_steps": 3}, "rust"),
        (TILES, "rust"),
        # In processes, for which every learner is the same; the two have other arrays to return.
        (TWO_TABLES, "gymnasium"),
        (TILES, "gymnasium"),
    ],
)
def test_each_run_equals_the_single_run_for_every_learner(config, backend):
    episodes = 12 if backend == "rust" else 2
    config = {**config, "episodes": episodes, "backend": backend}
    runs = qtab.train_many(CAR, 3, threads=2, tables=True, **config)
    assert_same_as_single_runs(runs, **config)
    assert runs[1].tables.shape == qtab.train(CAR, seed=1, **config).tables.shape


def test_a_batch_overflows_as_its_single_run_does():
    growing: dict[str, Any] = {**TILES, "tilings": 8, "learning_rate": 2.0, "discount": 1.0, "episodes": 60}
    growing |= {"epsilon": 0.8, "epsilon_schedule": "constant", "initial_q": (-1, 1)}
    with pytest.raises(OverflowError) as caught:
        qtab.train_many(CAR, 8, threads=1, **growing)
    seed = next(seed for seed in range(8) if f"seed {seed}" in str(getattr(caught.value, "__notes__", "seed 0")))
    if sys.version_info >= (3, 11):
        with pytest.raises(OverflowError) as single:
            qtab.train(CAR, seed=seed, **growing)
        assert str(caught.value) == str(single.value)


STEEP: dict[str, Any] = {
    "discretizer": "tiles",
    "algorithm": "sarsa_lambda",
    "traces": "accumulating",
    "trace_decay": 1.0,
}
STEEP |= {"learning_rate": 1.5, "discount": 1.0, "epsilon": 0.8, "min_epsilon": 0.8, "episodes": 4}


def test_a_failing_run_is_reported_with_its_seed_and_keeps_the_finished_ones():
    with pytest.raises(OverflowError) as single:
        qtab.train(CAR, seed=0, **STEEP)
    with pytest.raises(OverflowError) as caught:
        qtab.train_many(CAR, [1, 0, 2], threads=1, tables=True, **STEEP)
    assert str(caught.value) == str(single.value)
    assert "seed 0" in getattr(caught.value, "__notes__", ["seed 0"])[0]
    runs = run_of(caught.value)
    assert runs.seeds == (1,)
    assert not runs.completed
    assert_same_as_single_runs(runs, **STEEP)


def test_the_config_has_the_seed_of_the_first_run_that_finished(monkeypatch, tmp_path):
    """Threads finish in any order: an interruption may come while the first run is the only unfinished one."""
    module = importlib.import_module("qtab.training.train_many")
    train_in_threads = module.train_in_threads

    def interrupted(resolved, seeds, results, *others, **options):
        train_in_threads(resolved, seeds, results, *others, **options)
        results["finished"][0] = False
        raise KeyboardInterrupt

    monkeypatch.setattr(module, "train_in_threads", interrupted)
    with pytest.raises(KeyboardInterrupt) as caught:
        qtab.train_many(CAR, [4, 9, 2], tables=True, **SHORT)
    runs = run_of(caught.value)
    assert runs.seeds == (9, 2)
    assert runs.config.seed == 9
    assert qtab.train(config=runs.config).episode_returns.tobytes() == runs.episode_returns[0].tobytes()
    runs.save(tmp_path / "runs.npz")
    assert qtab.load_runs(tmp_path / "runs.npz").config == runs.config


def test_a_number_of_seeds_counts_from_zero():
    assert qtab.train_many(CAR, 3, **SHORT).seeds == (0, 1, 2)
    assert qtab.train_many(CAR, np.int64(2), **SHORT).seeds == (0, 1)  # type: ignore[arg-type]
    assert qtab.train_many(CAR, np.array([5, 3]), **SHORT).seeds == (5, 3)
    assert qtab.train_many(CAR, [2**70], **SHORT).seeds == (2**70,)


def test_a_run_can_be_taken_out_of_many(tmp_path):
    runs = qtab.train_many(CAR, [4, 9], tables=True, **SHORT)
    run = runs[-1]
    assert run.config.seed == 9
    run.save(tmp_path / "run.npz")
    assert qtab.load(tmp_path / "run.npz").q_table.tobytes() == qtab.train(CAR, seed=9, **SHORT).q_table.tobytes()
    assert [one.config.seed for one in runs] == [4, 9]
    with pytest.raises(IndexError):
        runs[2]
    with pytest.raises(ValueError, match="tables=True"):
        qtab.train_many(CAR, 1, **SHORT)[0]


def test_summaries_have_a_number_per_run():
    runs = qtab.train_many(CAR, 3, episodes=250)
    columns = runs.summaries()
    assert columns["seed"].tolist() == [0, 1, 2]
    assert columns["steps"].tolist() == runs.episode_lengths.sum(axis=1).tolist()
    assert columns["final_return"].tolist() == runs.final_returns().tolist()
    assert runs.mean_returns(100).shape == (3, 2)
    assert runs.mean_returns(100)[1].tolist() == qtab.train(CAR, seed=1, episodes=250).mean_returns(100).tolist()


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"seeds": 0}, ValueError, "seeds must be an integer of at least 1, got 0"),
        ({"seeds": []}, ValueError, "seeds must hold at least one seed"),
        ({"seeds": [3, 1, 3]}, ValueError, "seeds must differ from each other, got 3 twice"),
        ({"seeds": [-1]}, ValueError, r"^seeds\[0\] must be an integer of at least 0, got -1$"),
        ({"seeds": True}, TypeError, "seeds must be an integer"),
        ({"seeds": [True]}, TypeError, r"seeds\[0\] must be an integer"),
        ({"seeds": [1, "a"]}, TypeError, r"^seeds\[1\] must be an integer of at least 0, got 'a'$"),
        ({"seeds": 2.0}, TypeError, "seeds must be an integer or a sequence"),
        ({"seeds": "12"}, TypeError, "seeds must be an integer or a sequence"),
        ({"seeds": [2**32], "bit_generator": "MT19937"}, ValueError, "seed must be an integer from 0 to 4294967295"),
        ({"threads": 0}, ValueError, "threads must be an integer from 1 to 1024, got 0"),
        ({"threads": -2}, ValueError, "threads must be an integer from 1 to 1024, got -2"),
        ({"threads": 1025}, ValueError, "threads must be an integer from 1 to 1024, got 1025"),
        ({"threads": 1.5}, TypeError, "threads must be an integer"),
        ({"seed": 3}, TypeError, r"^unknown setting 'seed' \(did you mean 'seeds'\?\)$"),
        ({"episode": 3}, TypeError, r"^unknown setting 'episode' \(did you mean 'episodes'\?\)$"),
        ({"learning_rate": 2}, ValueError, "learning_rate must lie in"),
        ({"env": gym.make(CAR)}, TypeError, "env must be an id, an EnvSpec or a function that makes an environment"),
        ({"env": lambda: 3}, TypeError, "env must make an environment, got 3"),
        ({"env": 3}, TypeError, "env must be an environment id"),
        ({"memory_limit": 0}, ValueError, "memory_limit must be an integer of at least 1"),
        ({"memory_limit": 10**6}, MemoryError, "1,000 runs of 5,000 episodes would take 81.. MiB, more than memory"),
        ({"seeds": 10, "tables": True, "scale": (1e4, 1e4)}, MemoryError, "more than memory_limit"),
    ],
)
def test_bad_input_is_refused_before_anything_starts(arguments, error, message):
    with pytest.raises(error, match=message):
        qtab.train_many(**{"env": CAR, "memory_limit": 2**30, **arguments})


def test_the_memory_limit_can_be_raised():
    with pytest.raises(MemoryError):
        qtab.train_many(CAR, 10, memory_limit=15_000, **SHORT)
    assert len(qtab.train_many(CAR, 10, memory_limit=40_000, threads=1, **SHORT)) == 10

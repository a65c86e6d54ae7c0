"""Benchmarks that are compared do the same work, to the bit, beside what they measure."""

import os
import subprocess
import sys
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import environment_presets
import idle_env
import own_cars
import own_functions
import qtab
from algorithms import CUT, CUTOFF, LEARNERS
from loops import c_loop, numba_fourier, numba_loops, plain_loop, table_loop
from qtab.cli.commands import bench
from real_valued import FEATURES, FOURIER, SARSA
from support.repository import ROOT


def test_the_numba_loop_equals_the_articles_loop_to_the_bit() -> None:
    run = qtab.train("MountainCar-v0", episodes=100, seed=4, bit_generator="MT19937", backend="rust")
    starts = np.random.default_rng(4).uniform(-0.6, -0.4, 100)
    table, returns, steps = numba_loops.q_learning(starts, 4)
    assert table.tobytes() == run.q_table.tobytes()
    assert returns.tobytes() == run.episode_returns.tobytes()
    assert steps == run.episode_lengths.sum()


@pytest.mark.parametrize("make", [own_cars.limited, own_cars.limited_class])
def test_the_own_environments_equal_the_packages(make: Any) -> None:
    run = own_functions.train(make, 4, "python", 10)
    same = qtab.train("MountainCar-v0", seed=4, episodes=10, backend="rust")
    assert run.q_table.tobytes() == same.q_table.tobytes()
    assert run.episode_returns.tobytes() == same.episode_returns.tobytes()


def test_many_runs_under_numba_are_runs_with_different_seeds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba_loops, "EPISODES", 10)
    rows = np.random.default_rng(0).uniform(-0.6, -0.4, (3, 10))
    each = [numba_loops.q_learning(row, seed)[2] for seed, row in enumerate(rows)]
    assert numba_loops.many_runs(3, threads=2) == sum(each)


_COMPILED = """
import numpy as np
from loops import numba_loops, table_loop
numba_loops.EPISODES = 30
starts = np.random.default_rng(4).uniform(-0.6, -0.4, 30)
arguments = table_loop.arguments("FrozenLake-v1", 30)(4)
print(numba_loops.single_run(4), numba_loops.many_runs(3, threads=2), numba_loops.sarsa_lambda(starts, 4, 0.0)[2])
print(table_loop.q_learning(*arguments), arguments[5].tobytes().hex())
assert all(loop.signatures for loop in (numba_loops.parallel, numba_loops.sarsa_lambda, table_loop.q_learning))
"""


@pytest.mark.slow
def test_numba_compiles_the_loops_with_equal_results(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    variables = {**os.environ, "NUMBA_DISABLE_JIT": "0", "PYTHONPATH": str(ROOT / "benchmarks")}
    program = [sys.executable, "-c", _COMPILED]
    found = subprocess.run(program, env=variables, capture_output=True, text=True, check=True).stdout.split()
    monkeypatch.setattr(numba_loops, "EPISODES", 30)
    starts = np.random.default_rng(4).uniform(-0.6, -0.4, 30)
    steps = numba_loops.single_run(4), numba_loops.many_runs(3, 2), numba_loops.sarsa_lambda(starts, 4, 0.0)[2]
    assert found[:3] == [str(number) for number in steps]
    run = qtab.train("FrozenLake-v1", episodes=30, seed=4)
    assert found[3:] == [str(run.episode_lengths.sum()), run.q_table.tobytes().hex()]


def test_the_loop_in_c_equals_the_articles_loop_to_the_bit() -> None:
    q_learning = c_loop.build()
    if q_learning is None:
        pytest.skip("there is no compiler of C")
    run = qtab.train("MountainCar-v0", episodes=300, seed=4)
    table, steps = c_loop.train(q_learning, 4, 300)
    assert table.tobytes() == run.q_table.tobytes()
    assert steps == run.episode_lengths.sum()


def test_the_plain_loop_equals_the_articles_loop_to_the_bit() -> None:
    run = qtab.train("MountainCar-v0", episodes=30, seed=4)
    table, steps = bench.q_learning(30, 4)
    assert table.tobytes() == run.q_table.tobytes()
    assert steps == run.episode_lengths.sum()


@pytest.mark.parametrize("cutoff", [0.0, CUTOFF])
def test_the_numba_loop_of_sarsa_lambda_equals_ours_to_the_bit(cutoff: float) -> None:
    settings: dict[str, Any] = {**LEARNERS[CUT], "episodes": 6, "trace_cutoff": cutoff}
    run = qtab.train("MountainCar-v0", seed=4, bit_generator="MT19937", **settings)
    starts = np.random.default_rng(4).uniform(-0.6, -0.4, 6)
    table, returns, steps = numba_loops.sarsa_lambda(starts, 4, cutoff)
    assert table.tobytes() == run.tables.tobytes()
    assert returns.tobytes() == run.episode_returns.tobytes()
    assert steps == run.episode_lengths.sum()


def test_the_numba_loop_with_a_fourier_basis_equals_ours_to_the_bit() -> None:
    run = qtab.train("MountainCar-v0", seed=4, bit_generator="MT19937", episodes=4, **{**SARSA, **FEATURES[FOURIER]})
    starts = np.random.default_rng(4).uniform(-0.6, -0.4, 4)
    table, returns, steps = numba_fourier.sarsa(starts, 4, False)
    assert table.tobytes() == run.tables.tobytes()
    assert returns.tobytes() == run.episode_returns.tobytes()
    assert steps == run.episode_lengths.sum()
    by_cosines, by_products = (numba_fourier.sarsa(starts[:1], 4, how)[0] for how in (True, False))
    assert np.allclose(by_cosines, by_products, rtol=1e-9)


@pytest.mark.parametrize("name", environment_presets.TABLES)
def test_the_numba_loop_over_a_table_equals_ours_to_the_bit(name: str) -> None:
    run = qtab.train(name, episodes=30, seed=4)
    arguments = table_loop.arguments(name, 30)(4)
    assert table_loop.q_learning(*arguments) == run.episode_lengths.sum()
    assert arguments[5].tobytes() == run.q_table.tobytes()


@pytest.mark.parametrize("name", environment_presets.EPISODES)
def test_the_plain_loop_with_a_preset_equals_ours_to_the_bit(name: str) -> None:
    run = qtab.train(name, episodes=30, seed=4)
    table, steps = plain_loop.q_learning(name, 30, 4)
    assert table.tobytes() == run.q_table.tobytes()
    assert steps == run.episode_lengths.sum()


def test_the_bare_loop_seeds_the_idle_environment_as_training_does(monkeypatch: pytest.MonkeyPatch) -> None:
    seeds: list[int | None] = []

    class Recorded(idle_env.IdleEnv):
        def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
            seeds.append(seed)
            return super().reset(seed=seed, options=options)

    monkeypatch.setattr(idle_env, "IdleEnv", Recorded)
    monkeypatch.setattr(idle_env, "EPISODES", 3)
    for name, loop in idle_env.learning().benchmarks.items():
        seeds.clear()
        loop(7)
        assert seeds == [7, None, None], name


@pytest.mark.parametrize("name", environment_presets.TABLES)
def test_a_round_of_the_loop_over_a_table_makes_no_environment(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = [int(qtab.train(name, seed=seed, episodes=20).episode_lengths.sum()) for seed in (3, 4)]
    monkeypatch.setattr(environment_presets, "preset", lambda *_: (None, {"episodes": 20}))
    monkeypatch.setattr(numba_loops, "numba", True)
    loops = environment_presets.training().benchmarks
    loop = loops[f"{name.partition('-')[0]}, {environment_presets.NUMBA}"]

    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("the environment is made within the time that is measured")

    monkeypatch.setattr(gym, "make", refuse)
    assert [loop(3), loop(4), loop(3)] == [*expected, expected[0]]

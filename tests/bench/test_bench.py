"""The benchmarks count their steps and print their tables; no test asserts a time."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab as package
from qtab._utils.versions import versions
from qtab.bench import (
    article,
    article_c,
    article_numba,
    book,
    environments,
    footprint,
    learners,
    measure,
    mountain_car,
    overhead,
    plain_loop,
    report,
    sarsa_numba,
    table_numba,
    vector_envs,
)
from qtab.bench.timing import Benchmark, Timings
from qtab.config.presets import preset
from support.command import qtab_here, refused


def test_the_numba_loop_equals_the_articles_loop_to_the_bit() -> None:
    run = package.train("MountainCar-v0", episodes=100, seed=4, bit_generator="MT19937", backend="rust")
    starts = np.random.default_rng(4).uniform(-0.6, -0.4, 100)
    table, returns, steps = article_numba.q_learning(starts, 4, 0.2, 0.9, 0.8, 0.0)
    assert table.tobytes() == run.q_table.tobytes()
    assert returns.tobytes() == run.episode_returns.tobytes()
    assert steps == run.episode_lengths.sum()


def test_the_loop_in_c_equals_the_articles_loop_to_the_bit() -> None:
    q_learning = article_c.build()
    if q_learning is None:
        pytest.skip("there is no compiler of C")
    run = package.train("MountainCar-v0", episodes=300, seed=4)
    table, steps = article_c.train(q_learning, 4, 300)
    assert table.tobytes() == run.q_table.tobytes()
    assert steps == run.episode_lengths.sum()


def test_without_a_compiler_there_is_no_loop_in_c(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(article_c, "COMPILERS", ("no_compiler",))
    assert article_c.compiled() is None
    monkeypatch.setattr(article_c, "COMPILERS", ("false",))
    assert article_c.compiled() is None


def test_the_plain_loop_equals_the_articles_loop_to_the_bit() -> None:
    run = package.train("MountainCar-v0", episodes=30, seed=4)
    table, steps = article.q_learning(gym.make("MountainCar-v0"), 0.2, 0.9, 0.8, 0.0, 30, 4)
    assert table.tobytes() == run.q_table.tobytes()
    assert steps == run.episode_lengths.sum()


@pytest.mark.parametrize("cutoff", [0.0, learners.CUTOFF])
def test_the_numba_loop_of_sarsa_lambda_equals_ours_to_the_bit(cutoff: float) -> None:
    settings: dict[str, Any] = {**learners.SETTINGS[learners.CUT], "episodes": 6, "trace_cutoff": cutoff}
    run = package.train("MountainCar-v0", seed=4, bit_generator="MT19937", **settings)
    starts = np.random.default_rng(4).uniform(-0.6, -0.4, 6)
    table, returns, steps = sarsa_numba.sarsa_lambda(sarsa_numba.observe, starts, 4, 0.3, 0.9, cutoff)
    assert table.tobytes() == run.tables.tobytes()
    assert returns.tobytes() == run.episode_returns.tobytes()
    assert steps == run.episode_lengths.sum()


@pytest.mark.parametrize("name", environments.TABLES)
def test_the_numba_loop_over_a_table_equals_ours_to_the_bit(name: str) -> None:
    run = package.train(name, episodes=30, seed=4)
    arguments = table_numba.arguments(name, 30)(4)
    assert table_numba.q_learning(*arguments) == run.episode_lengths.sum()
    assert arguments[5].tobytes() == run.q_table.tobytes()


@pytest.mark.slow
def test_numba_compiles_the_loops(monkeypatch: pytest.MonkeyPatch) -> None:
    numba: Any = pytest.importorskip("numba")
    for module in (article_numba, sarsa_numba):
        monkeypatch.setattr(module, "EPISODES", 30)
    starts = np.random.default_rng(4).uniform(-0.6, -0.4, 30)
    q_learning, sarsa_lambda = article_numba.compiled(), sarsa_numba.compiled(0.9, 0.0)
    assert q_learning is not None
    assert sarsa_lambda is not None
    expected = package.train("FrozenLake-v1", episodes=30, seed=4).q_table.tobytes()
    table = table_numba.arguments("FrozenLake-v1", 30)(4)
    numba.njit(table_numba.q_learning)(*table)
    assert table[5].tobytes() == expected
    many = article_numba.compiled_many(2)
    assert many is not None
    rows = np.random.default_rng(0).uniform(-0.6, -0.4, (3, 30))
    each = [article_numba.q_learning(row, seed, 0.2, 0.9, 0.8, 0.0)[2] for seed, row in enumerate(rows)]
    assert many(3) == sum(each)
    assert q_learning(4) == article_numba.q_learning(starts, 4, 0.2, 0.9, 0.8, 0.0)[2]
    assert sarsa_lambda(4) == sarsa_numba.sarsa_lambda(sarsa_numba.observe, starts, 4, 0.3, 0.9, 0.0)[2]


@pytest.mark.parametrize("name", environments.names())
def test_the_plain_loop_with_a_preset_equals_ours_to_the_bit(name: str) -> None:
    run = package.train(name, episodes=30, seed=4)
    table, steps = plain_loop.q_learning(name, 30, 4)
    assert table.tobytes() == run.q_table.tobytes()
    assert steps == run.episode_lengths.sum()


def test_benchmarks_alternate_and_ratios_are_computed_within_a_round() -> None:
    turns: list[str] = []

    def benchmark(name: str) -> Benchmark:
        def run(index: int) -> int:
            turns.append(f"{name}{index}")
            return 1

        return run

    timings = measure({"a": benchmark("a"), "b": benchmark("b")}, seconds=0, rounds=2)
    assert turns == ["a0", "b0", "a1", "b1", "a2", "b2"]
    assert {name: len(times) for name, times in timings.nanoseconds.items()} == {"a": 2, "b": 2}
    drifting = Timings({"slow": np.array([10.0, 200.0, 30.0]), "fast": np.array([1.0, 20.0, 3.0])})
    assert drifting.ratio("slow", "fast") == 10.0
    assert drifting.median("slow") == 30.0


def test_the_overhead_of_learning_is_a_difference_within_each_round() -> None:
    times = {overhead.BARE: np.array([100.0, 400.0, 200.0]), overhead.LEARNING: np.array([350.0, 600.0, 410.0])}
    assert overhead.sentence(Timings(times)).startswith("learning adds 210 ns per step")


def test_every_benchmark_counts_its_steps() -> None:
    training = mountain_car.training()
    assert 1900 <= training[mountain_car.ARTICLE](0) <= 2000
    assert training[mountain_car.TRAIN](0) == package.train("MountainCar-v0", seed=0).episode_lengths.sum()
    assert all(step(0) == mountain_car.STEPS for step in mountain_car.stepping().values())
    single = f"Taxi, {environments.METHODS[1]}"
    assert environments.training()[single](0) == package.train("Taxi-v4", seed=0).episode_lengths.sum()
    cut = package.train("MountainCar-v0", seed=0, **learners.SETTINGS[learners.CUT])
    assert learners.training()[learners.CUT](0) == cut.episode_lengths.sum()
    idle = overhead.EPISODES * overhead.EPISODE_STEPS
    assert [loop(0) for loop in overhead.python_stepping().values()] == [idle, idle]


def test_the_benchmarks_of_the_book_count_their_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(book, "EPISODES", 2000)
    monkeypatch.setattr(book, "PROBLEMS", 2)
    training = book.training()
    assert set(training) == {name for _, names in book.GROUPS for name in names}
    assert training[book.BANDIT](1) == 2 * book.STEPS
    # The lengths of episodes have a standard deviation of 80.
    steps = training[book.WALK](0)
    assert abs(steps / 2000 - book.WALK_STEPS) < 4 * 80 / 2000**0.5
    assert training["TD(0), 19-state random walk"](0) == 2000 * book.WALK_STEPS


@pytest.mark.slow
def test_vector_benchmarks_count_all_steps_and_are_compared_within_their_environment() -> None:
    steps = vector_envs.stepping()
    assert steps[vector_envs.QTAB_POLES](0) == 200 * 4096
    assert steps[vector_envs.QTAB_ONE](0) == 10_000
    nanoseconds = {
        vector_envs.SYNC: 900.0,
        vector_envs.QTAB_CARS: 3.0,
        vector_envs.NUMPY_POLES: 8.0,
        vector_envs.QTAB_POLES: 2.0,
    }
    rows = dict(vector_envs.compared(Timings({name: np.array([number]) for name, number in nanoseconds.items()})))
    assert rows == {
        vector_envs.SYNC: [1.0, None, None],
        vector_envs.QTAB_CARS: [300.0, None, None],
        vector_envs.NUMPY_POLES: [1.0, None, None],
        vector_envs.QTAB_POLES: [4.0, None, None],
    }


def _not_compiled(function: Any = None, **_: Any) -> Any:
    return _not_compiled if function is None else function


@pytest.fixture
def small_rounds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes a round of every benchmark short: few episodes, seeds and sub-environments, and nothing is compiled."""

    def train(env: Any, **settings: Any) -> package.Run:
        return package.train(env, **{**settings, "episodes": 20})

    def train_many(env: Any, seeds: int, **settings: Any) -> package.Runs:
        return package.train_many(env, seeds // 8, **settings, episodes=20)

    for module in (mountain_car, environments, learners, overhead, book):
        monkeypatch.setattr(module, "train", train)
    for module in (mountain_car, environments):
        monkeypatch.setattr(module, "train_many", train_many)
    monkeypatch.setattr(environments, "EPISODES", dict.fromkeys(environments.EPISODES, 20))
    monkeypatch.setattr(table_numba, "preset", lambda name, _: (None, {**preset(name, None)[1], "episodes": 20}))
    for module in (article_c, article_numba, sarsa_numba):
        monkeypatch.setattr(module, "EPISODES", 1)
    numba = SimpleNamespace(njit=_not_compiled, prange=range, set_num_threads=lambda threads: None)
    monkeypatch.setitem(sys.modules, "numba", numba)
    monkeypatch.setattr(book, "EPISODES", 20)
    monkeypatch.setattr(book, "PROBLEMS", 2)
    monkeypatch.setattr(mountain_car, "STEPS", 1_000)
    monkeypatch.setattr(vector_envs, "NUM_ENVS", 8)
    monkeypatch.setattr(report, "footprint", lambda: footprint.footprint(repeats=1))


@pytest.mark.slow
def test_the_bench_prints_its_tables_with_versions_and_build(small_rounds: None) -> None:
    printed = str(report.bench(rounds=1, progress=False))
    names = (
        mountain_car.ARTICLE,
        mountain_car.TRAIN,
        mountain_car.GYMNASIUM_STEP,
        mountain_car.QTAB_STEP,
        mountain_car.QTAB_MAKE,
    )
    for name in (*names, vector_envs.SYNC, vector_envs.QTAB_CARS, vector_envs.QTAB_POLES, vector_envs.QTAB_ONE):
        assert f"\n{name}  " in printed
    tables = (f"{name.partition('-')[0]}, {environments.NUMBA}" for name in environments.TABLES)
    for name in (
        environments.FIRST,
        mountain_car.NUMBA_ON_TWO,
        *tables,
        *learners.SETTINGS,
        *learners.MANY,
        *(name for _, names in book.GROUPS for name in names),
    ):
        assert f"\n{name}  " in printed
    assert "learning adds" in printed
    assert "import qtab adds" in printed
    assert f"numpy {np.__version__}" in printed
    assert f"build {versions()['build']}" in printed


def test_a_part_can_be_timed_separately(small_rounds: None, tmp_path: Path) -> None:
    done = qtab_here("bench", "--rounds", "1", "--part", "stepping", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert f"\n{mountain_car.QTAB_STEP}  " in done.stdout
    assert "import qtab adds" in done.stdout
    assert f"build {versions()['build']}" in done.stdout
    assert not any(name in done.stdout for name in (mountain_car.TRAIN, environments.FIRST, learners.Q_LEARNING))


def test_the_time_of_a_learner_is_relative_to_q_learning() -> None:
    times = dict.fromkeys(learners.SETTINGS, np.array([30.0, 60.0])) | {learners.Q_LEARNING: np.array([10.0, 20.0])}
    times |= dict.fromkeys(learners.NUMBA, np.array([90.0, 180.0]))
    rows = {name: columns for name, *columns in learners.lines(Timings(times))}
    assert rows[learners.TRACES] == ["45.0", "3.00", "3.0"]
    assert rows[learners.Q_LEARNING] == ["15.0", "1.00", ""]


def test_the_report_names_the_extra_for_numba_and_warns_of_a_debug_build() -> None:
    names = [mountain_car.ARTICLE, mountain_car.TRAIN, mountain_car.GYMNASIUM_STEP, mountain_car.QTAB_STEP]
    names += [mountain_car.GYMNASIUM_MAKE, mountain_car.QTAB_MAKE]
    timings = Timings({name: np.array([1.0]) for name in names})
    printed = str(report.Report(timings, 1, footprint.Footprint(200.0, 5.0, None), {"build": "debug"}))
    assert printed.startswith("WARNING: this is a debug build")
    assert "pip install numba" in printed
    assert "× numba" not in printed


def test_json_holds_the_median_and_all_rounds(small_rounds: None, tmp_path: Path) -> None:
    done = qtab_here("bench", "--rounds", "2", "--part", "stepping", "--json", cwd=tmp_path)
    content = json.loads(done.stdout)
    found = content["benchmarks"][mountain_car.QTAB_STEP]
    assert found["ns_per_step"] == np.median(found["rounds"])
    assert content["rounds"] == len(found["rounds"]) == 2
    assert content["versions"] == versions()


@pytest.mark.parametrize("arguments", [["--rounds", "0"], ["--seconds", "-1"], ["--laps", "3"], ["--part", "whole"]])
def test_bad_usage_is_refused(tmp_path: Path, arguments: list[str]) -> None:
    assert refused("bench", *arguments, cwd=tmp_path).startswith("qtab bench: error: ")

"""``qtab bench`` and ``benchmarks/`` count their steps and print their tables; no test asserts a time."""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest

import algorithms
import compare
import environment_presets
import footprint
import idle_env
import mountain_car
import own_library
import own_start
import qtab as package
import real_valued
import tables
import vector_envs
from loops import c_loop, numba_loops
from qtab._utils.versions import versions
from qtab.cli.commands import bench
from support.processes.command import environment, qtab_here, refused
from support.repository import ROOT
from tables import Benchmark, Column, Table


def test_benchmarks_alternate_and_the_first_round_is_not_counted() -> None:
    turns: list[str] = []

    def benchmark(name: str) -> Benchmark:
        def run(index: int) -> int:
            turns.append(f"{name}{index}")
            return 1

        return run

    times = bench.measure({"a": benchmark("a"), "b": benchmark("b")}, 0.0, 2)
    assert turns == ["a0", "b0", "a1", "b1", "a2", "b2"]
    assert {name: row.shape for name, row in times.items()} == {"a": (2,), "b": (2,)}
    turns.clear()
    assert len(bench.measure({"a": benchmark("a")}, 0.0, None)["a"]) == 3


def test_benchmarks_are_compared_within_each_round() -> None:
    times = {"slow": np.array([10.0, 200.0, 30.0]), "fast": np.array([1.0, 20.0, 3.0])}
    columns = (
        Column("×", {"fast": "slow", "slow": "absent"}),
        Column("rel.", {"fast": "slow"}, tables.relative_time),
        Column("added", {"slow": "fast"}, tables.added_time),
    )
    head, slow, fast = Table("title", {}, columns).text(times).splitlines()
    assert head.split() == ["title", "ns/step", "×", "rel.", "added"]
    assert slow.split() == ["slow", "30.0", "27.0"]
    assert fast.split() == ["fast", "3.0", "10.0", "0.1"]
    least = Table("title", {}, columns, minimum=True).text(times).splitlines()
    assert [row.split() for row in least[1:]] == [["slow", "10.0", "9.0"], ["fast", "1.0", "10.0", "0.1"]]


def test_every_benchmark_counts_its_steps() -> None:
    training = mountain_car.training().benchmarks
    assert 1900 <= training[bench.ARTICLE](0) <= 2000
    assert training[bench.TRAIN](0) == package.train("MountainCar-v0", seed=0).episode_lengths.sum()
    assert all(step(0) == mountain_car.STEPS for step in mountain_car.stepping().benchmarks.values())
    single = environment_presets.training().benchmarks[f"Taxi, {environment_presets.TRAIN}"]
    assert single(0) == package.train("Taxi-v4", seed=0).episode_lengths.sum()
    cut = package.train("MountainCar-v0", seed=0, **algorithms.LEARNERS[algorithms.CUT])
    assert algorithms.learners().benchmarks[algorithms.CUT](0) == cut.episode_lengths.sum()
    waves = package.train(
        "MountainCar-v0", seed=0, **real_valued.SARSA, **real_valued.FEATURES[real_valued.FOURIER], episodes=300
    )
    assert real_valued.learning().benchmarks[real_valued.FOURIER](0) == waves.episode_lengths.sum()
    idle = idle_env.EPISODES * idle_env.EPISODE_STEPS
    assert [loop(0) for loop in idle_env.learning().benchmarks.values()] == [idle, idle]


def test_the_benchmarks_of_the_book_count_their_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(algorithms, "EPISODES", 2000)
    monkeypatch.setattr(algorithms, "PROBLEMS", 2)
    monkeypatch.setattr(own_library, "EPISODES_IN_PYTHON", 1)
    loops = algorithms.book().benchmarks
    assert set(loops) == {*algorithms.BANDITS, algorithms.WALK, *algorithms.PREDICTION, *algorithms.CONTROL}
    assert loops[algorithms.BANDIT](1) == 2 * algorithms.STEPS
    # The lengths of episodes have a standard deviation of 80.
    steps = loops[algorithms.WALK](0)
    assert abs(steps / 2000 - algorithms.WALK_STEPS) < 4 * 80 / 2000**0.5
    assert loops["TD(0), 19-state random walk"](0) == 2000 * algorithms.WALK_STEPS


@pytest.mark.slow
def test_vector_benchmarks_count_all_steps_and_are_compared_within_their_environment() -> None:
    table = vector_envs.stepping()
    assert table.benchmarks[vector_envs.QTAB_POLES](0) == 200 * 4096
    assert table.benchmarks[vector_envs.QTAB_ONE](0) == 10_000
    nanoseconds = {
        mountain_car.QTAB_MAKE: 500.0,
        vector_envs.SYNC: 900.0,
        vector_envs.QTAB_CARS: 3.0,
        vector_envs.NUMPY_POLES: 8.0,
        vector_envs.QTAB_POLES: 2.0,
        vector_envs.QTAB_ONE: 250.0,
    }
    printed = table.text({name: np.array([number]) for name, number in nanoseconds.items()}).splitlines()[1:]
    ratios = [line.removeprefix(name).split()[1:] for name, line in zip(nanoseconds, printed, strict=True)]
    assert ratios == [[], ["1.0"], ["300"], ["1.0"], ["4.0"], ["2.0"]]


@pytest.fixture
def small_rounds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes a round of every benchmark short: few episodes, seeds and sub-environments."""
    train, train_many = package.train, package.train_many

    def short(env: Any, **settings: Any) -> package.Run:
        return train(env, **{**settings, "episodes": 20})

    def short_many(env: Any, seeds: int, **settings: Any) -> package.Runs:
        return train_many(env, seeds // 8, **{**settings, "episodes": 20})

    monkeypatch.setattr(package, "train", short)
    monkeypatch.setattr(package, "train_many", short_many)
    monkeypatch.setattr(bench, "train", short)
    monkeypatch.setattr(environment_presets, "EPISODES", dict.fromkeys(environment_presets.EPISODES, 20))
    monkeypatch.setattr(environment_presets, "preset", lambda *_: (None, {"episodes": 20}))
    monkeypatch.setattr(numba_loops, "numba", mock.MagicMock())  # of which the loops set the number of threads
    monkeypatch.setattr(numba_loops, "EPISODES", 1)
    monkeypatch.setitem(algorithms._TILES, "episodes", 1)
    monkeypatch.setattr(algorithms, "EPISODES", 20)
    monkeypatch.setattr(algorithms, "PROBLEMS", 2)
    monkeypatch.setattr(mountain_car, "STEPS", 1_000)
    monkeypatch.setattr(vector_envs, "NUM_ENVS", 8)


@pytest.mark.slow
def test_the_comparison_prints_its_tables_with_versions_and_build(
    small_rounds: None, capsys: pytest.CaptureFixture[str]
) -> None:
    compare.main(["--rounds", "1"])
    printed = capsys.readouterr().out
    for makers in compare.PARTS.values():
        for make in makers:
            table = make()
            assert f"{table.title}  " in printed
            assert [name for name in table.benchmarks if f"\n{name}  " not in printed] == []
    for name in (mountain_car.NUMBA_ON_TWO, f"Taxi, {environment_presets.NUMBA}", *algorithms.NUMBA.values()):
        assert f"\n{name}  " in printed
    assert f"numpy {np.__version__}" in printed
    assert f"build {versions()['build']}" in printed


def test_a_part_can_be_timed_separately(small_rounds: None, capsys: pytest.CaptureFixture[str]) -> None:
    compare.main(["stepping", "--rounds", "1"])
    printed = capsys.readouterr().out
    assert f"\n{mountain_car.QTAB_STEP}  " in printed
    assert f"\n{idle_env.LEARNING}  " in printed
    assert not any(name in printed for name in (bench.ARTICLE, algorithms.Q_LEARNING, environment_presets.PLAIN))
    with pytest.raises(SystemExit):
        compare.main(["whole"])
    assert "PART must be one of training, environments, " in capsys.readouterr().err
    with pytest.raises(SystemExit):
        compare.main(["stepping", "--rounds", "0"])
    assert "--rounds must be at least 1, got 0" in capsys.readouterr().err


def test_it_warns_of_a_debug_build_and_of_missing_numba(
    small_rounds: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(compare, "versions", lambda: {"build": "debug"})
    monkeypatch.setattr(numba_loops, "numba", None)
    compare.main(["training", "--rounds", "1"])
    printed = capsys.readouterr().out
    assert printed.startswith("WARNING: this is a debug build")
    assert "pip install numba" in printed
    assert mountain_car.NUMBA not in printed


@pytest.mark.slow
def test_the_second_start_of_a_class_loads_the_code_of_the_first(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    pytest.importorskip("numba")
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    shutil.copy(ROOT / "benchmarks" / "own_cars.py", tmp_path)
    written = []
    for _ in range(2):
        assert own_start._run_class(tmp_path) > 0
        written.append({(path, path.stat().st_mtime_ns) for path in tmp_path.rglob("*.compiled")})
    assert len(written[0]) == 1
    assert written[0] == written[1]


def test_the_footprint_is_one_sentence() -> None:
    assert footprint.footprint(repeats=1).startswith("import qtab adds ")


@pytest.mark.slow
def test_the_comparison_is_a_program_that_runs_anywhere(tmp_path: Path) -> None:
    program = [sys.executable, str(ROOT / "benchmarks" / "compare.py"), "--help"]
    done = subprocess.run(program, cwd=tmp_path, env=environment(), capture_output=True, text=True, check=True)
    assert "--seconds" in done.stdout


def test_without_a_compiler_there_is_no_loop_in_c(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(c_loop, "COMPILERS", ("no_compiler",))
    assert c_loop.build() is None
    monkeypatch.setattr(c_loop, "COMPILERS", ("false",))
    assert c_loop.build() is None
    assert mountain_car.C not in mountain_car.training().benchmarks


def test_the_command_prints_the_medians_with_versions(small_rounds: None, tmp_path: Path) -> None:
    done = qtab_here("bench", "--rounds", "2", "--part", "training", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("A step of MountainCar-v0 takes ")
    assert "(medians of 2 rounds)" in done.stdout
    assert f"build {versions()['build']}" in done.stdout


def test_json_holds_the_median_and_all_rounds(small_rounds: None, tmp_path: Path) -> None:
    done = qtab_here("bench", "--rounds", "2", "--json", cwd=tmp_path)
    content = json.loads(done.stdout)
    found = content["benchmarks"][bench.TRAIN]
    assert found["ns_per_step"] == np.median(found["rounds"])
    assert content["rounds"] == len(found["rounds"]) == 2
    assert content["versions"] == versions()


@pytest.mark.parametrize("arguments", [["--rounds", "0"], ["--seconds", "-1"], ["--laps", "3"]])
def test_bad_usage_is_refused(tmp_path: Path, arguments: list[str]) -> None:
    assert refused("bench", *arguments, cwd=tmp_path).startswith("qtab bench: error: ")


@pytest.mark.parametrize("part", ["stepping", "whole"])
def test_a_part_that_moved_is_refused_with_its_new_place(tmp_path: Path, part: str) -> None:
    answer = refused("bench", "--part", part, cwd=tmp_path)
    assert f"--part must be training, got '{part}'; python benchmarks/compare.py" in answer

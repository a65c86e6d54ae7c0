"""Compiled environments with the other features of the package: the results are those of training in Python."""

import copy
import pickle
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.callbacks import Checkpoint, EvaluateEvery
from support.environments.stairs import OrdinaryStairs, Stairs, register
from support.parity import run_of

pytest.importorskip("numba")

BOTH = pytest.mark.parametrize("made", [Stairs, OrdinaryStairs])
IDS = {"tests/Stairs-v0": Stairs, "tests/OrdinaryStairs-v0": OrdinaryStairs}


def trained(env: Any, backend: Any = "numba", **chosen: Any) -> qtab.Run:
    return qtab.train(env, backend=backend, **{"episodes": 12, "seed": 3, "max_episode_steps": 30} | chosen)


def assert_same(one: qtab.Run, other: qtab.Run) -> None:
    assert one.tables.tobytes() == other.tables.tobytes()
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    assert one.episode_lengths.tobytes() == other.episode_lengths.tobytes()


@pytest.fixture
def ids() -> Iterator[list[str]]:
    register()
    yield list(IDS)
    for name in IDS:
        del gym.registry[name]


@BOTH
@pytest.mark.parametrize(
    "chosen",
    [
        {"action_mask": True, "record": 2, "visits": True},
        {"time_aware": True},
        {"action_mask": True, "time_aware": True, "algorithm": "sarsa"},
    ],
    ids=str,
)
def test_settings(made: Any, chosen: dict[str, Any]) -> None:
    one, other = (trained(made(), backend, **chosen) for backend in ("numba", "python"))
    assert (one.config.backend, other.config.backend) == ("rust" if made is Stairs else "numba", "gymnasium")
    assert_same(one, other)
    if one.visits is not None and other.visits is not None:
        assert one.visits.tobytes() == other.visits.tobytes()
    for ours, theirs in zip(one.recordings, other.recordings, strict=True):
        assert list(ours.actions) == list(theirs.actions)
        assert ours.start["state"] == theirs.start["state"]


@BOTH
def test_the_memory_limit_counts_the_tables(made: Any) -> None:
    assert_same(trained(made(), memory_limit=10**9), trained(made(), "python"))
    with pytest.raises((MemoryError, ValueError), match="memory_limit"):
        trained(made(), memory_limit=10)


@BOTH
def test_callbacks(made: Any, tmp_path: Path) -> None:
    found = []
    for backend in ("numba", "python"):
        evaluation = EvaluateEvery(episodes=3, every=4, env=made())
        checkpoint = Checkpoint(tmp_path / f"{backend}.npz", every=5)
        trained(made(), backend, callback=[evaluation, checkpoint], callback_every=1)
        found.append((evaluation, qtab.load(tmp_path / f"{backend}.npz")))
    (ours, one), (theirs, other) = found
    assert ours.mean_returns.tobytes() == theirs.mean_returns.tobytes()
    assert_same(one, other)


@BOTH
def test_resume_within_an_episode(made: Any, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    endless: dict[str, Any] = {"algorithm": "monte_carlo", "max_episode_steps": 20_000, "episodes": 2}
    with pytest.raises(MemoryError, match="memory_limit=150000") as caught:
        trained(made(1.0), memory_limit=150_000, **endless)
    part = run_of(caught.value)
    assert len(part.state.checkpoint) > 10_000  # the steps of the unfinished episode
    part.save(tmp_path / "part.npz")
    resumed = qtab.resume(qtab.load(tmp_path / "part.npz"), env=made(1.0))
    assert "stopped within" not in caplog.text
    assert_same(resumed, trained(made(1.0), "python", **endless))


@BOTH
def test_functions_of_a_saved_run(made: Any, tmp_path: Path) -> None:
    runs = []
    for backend in ("numba", "python"):
        part = trained(made(), backend, callback=lambda progress: False, callback_every=5)
        part.save(tmp_path / "run.npz")
        runs.append(qtab.load(tmp_path / "run.npz"))
    one, other = runs
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    evaluated = [qtab.evaluate(run, env=made(), episodes=3, seed=5).returns.tobytes() for run in runs]
    assert evaluated[0] == evaluated[1]
    shown = [str(qtab.explain(run, env=made(), episode=1)) for run in runs]
    assert shown[0] == shown[1]
    assert_same(*(qtab.resume(run, env=made()) for run in runs))
    assert qtab.verify(one, 5, env=made()).equal


@BOTH
def test_a_changed_attribute_is_noticed(made: Any) -> None:
    env = made()
    part = trained(env, callback=lambda progress: False, callback_every=5)
    env.slip = 0.5
    with pytest.raises(ValueError, match=r"env must be that of the run.*slip"):
        qtab.resume(part, env=env)
    with pytest.raises(ValueError, match=r"env must be that of the run.*slip"):
        qtab.verify(part, 5, env=env)


@BOTH
def test_diagnose(made: Any, ids: list[str]) -> None:
    name = next(one for one in ids if IDS[one] is made)
    found = [
        [one.name for one in qtab.diagnose(trained(name, backend), seeds=2).findings] for backend in ("numba", "python")
    ]
    assert found[0] == found[1]


@BOTH
def test_many_runs_on_two_threads(made: Any) -> None:
    def make() -> Any:
        env = made()
        env.slip = 0.6
        return env

    shared: dict[str, Any] = {"episodes": 12, "max_episode_steps": 30}
    many = qtab.train_many(make, seeds=4, threads=2, tables=True, backend="numba", **shared)
    for seed, run in enumerate(many):
        assert_same(run, trained(make(), "python", seed=seed))


def test_sweeps_in_a_worker_process(ids: list[str]) -> None:
    grid, shared = {"learning_rate": [0.1, 0.5]}, {"seeds": 2, "episodes": 10, "progress": False}
    with ProcessPoolExecutor(1, get_context("spawn"), register) as executor:
        for name in ids:
            one = qtab.sweep(name, grid, executor=executor, backend="numba", **shared)  # type: ignore[arg-type]
            other = qtab.sweep(name, grid, backend="gymnasium", **shared)  # type: ignore[arg-type]
            assert one.failed == other.failed == 0
            assert one.mean_final_returns().tobytes() == other.mean_final_returns().tobytes()


@BOTH
def test_vector_environments(made: Any, ids: list[str]) -> None:
    name = next(one for one in ids if IDS[one] is made)
    trained(name)
    vector, singles = gym.make_vec(name, num_envs=2, vectorization_mode="sync"), [gym.make(name) for _ in range(2)]
    assert list(vector.reset(seed=5)[0]) == [env.reset(seed=5 + i)[0] for i, env in enumerate(singles)]
    for _ in range(4):
        stepped = [env.step(1) for env in singles]
        observations, rewards, *_ = vector.step(np.array([1, 1]))
        assert list(zip(observations, rewards, strict=True)) == [(one[0], one[1]) for one in stepped]
    assert qtab.RustVectorEnv(name, 2).is_native


@BOTH
@pytest.mark.parametrize(
    "wrap",
    [
        lambda env: gym.wrappers.TimeLimit(env, 20),
        lambda env: gym.wrappers.OrderEnforcing(gym.wrappers.TimeLimit(env, 20)),
    ],
)
def test_wrappers_of_gymnasium(made: Any, wrap: Any) -> None:
    one, other = (trained(wrap(made()), backend, max_episode_steps=None) for backend in ("numba", "python"))
    assert one.config.backend != "gymnasium"
    assert_same(one, other)


@BOTH
def test_other_wrappers_are_refused_by_name(made: Any) -> None:
    with pytest.raises(ValueError, match=r"'numba'.*wrapper TransformReward"):
        trained(gym.wrappers.TransformReward(made(), lambda reward: reward))


@BOTH
def test_copies_and_pickles(made: Any) -> None:
    env = made(0.4)
    first = trained(env)
    for copied in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):  # noqa: S301
        assert_same(trained(copied), first)
        copied.slip = 0.0
        assert not np.array_equal(trained(copied).episode_lengths, first.episode_lengths)
    assert_same(trained(env), first)

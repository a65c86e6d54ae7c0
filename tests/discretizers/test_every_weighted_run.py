"""Every algorithm with every kind of weighted features: a run is that of the reference, however it is trained.

The cases are those of the tables of the package, so that a new algorithm or kind is tested without a change here.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.config.options import LEARNS_WEIGHTED, OPTIONS, PREFERENCES, WEIGHTED
from support.processes.posix import posix_only
from support.processes.timer import stopped_by_a_timer

CASES = [pytest.param(kind, algorithm, id=f"{kind}-{algorithm}") for kind in WEIGHTED for algorithm in LEARNS_WEIGHTED]
OF_KIND: dict[str, dict[str, Any]] = {
    "fourier": {"order": 1},
    "polynomial": {"order": 2, "coupled": False},
    "radial": {"centers": (2, 2, 3, 2), "normalized": True},
    "coarse": {"centers": (2, 2, 3, 2), "radius": (1.1, 1.0, 1.5, 1.2)},
}
OF_ALGORITHM: dict[str, Any] = {
    "trace_decay": 0.8,
    "trace_cutoff": 0.003,
    "n_steps": 3,
    "sigma": 0.5,
    "reward_learning_rate": 0.02,
    "value_learning_rate": 0.01,
}


def settings_of(kind: str, algorithm: Any) -> dict[str, Any]:
    """Episodes of CartPole that end in both ways, with rates that fall, and every option of the algorithm."""
    exploration = {"temperature": 0.7} if algorithm in PREFERENCES else {"epsilon": 0.3, "min_epsilon": 0.1}
    return {
        "algorithm": algorithm,
        "discretizer": kind,
        "preset": None,
        "low": (-2.4, -3, -0.2, -3),
        "high": (2.4, 3, 0.2, 3),
        "learning_rate": 0.02,
        "min_learning_rate": 0.001,
        "initial_q": (-0.5, 0.5),
        "max_episode_steps": 11,
        "progress": False,
        **OF_KIND[kind],
        **exploration,
        **{name: value for name, value in OF_ALGORITHM.items() if algorithm in OPTIONS[name].values},
    }


def parts(run: qtab.Run, episodes: int | None = None) -> list[bytes]:
    arrays = (run.episode_returns, run.episode_lengths, run.terminated)
    return [array[:episodes].tobytes() for array in arrays]


@pytest.mark.parametrize(("kind", "algorithm"), CASES)
def test_a_run_is_that_of_the_reference_alone_and_among_others_and_in_python(kind: str, algorithm: Any) -> None:
    settings = settings_of(kind, algorithm)
    several = qtab.train_many("CartPole-v1", seeds=[5, 6, 7], threads=2, tables=True, episodes=6, **settings)
    assert several.tables is not None
    run = qtab.train("CartPole-v1", seed=6, episodes=6, **settings)
    assert several.tables[1].tobytes() == run.tables.tobytes()
    assert {bool(ended) for ended in several.terminated.flat} == {False, True}
    assert np.isfinite(run.tables).all()
    verification = qtab.verify(run)
    assert verification.equal, verification
    stepped_in_python = qtab.train("CartPole-v1", seed=6, episodes=6, backend="gymnasium", **settings)
    assert parts(stepped_in_python) == parts(run)
    assert stepped_in_python.tables.tobytes() == run.tables.tobytes()
    assert len(qtab.explain(run, 1, steps=3).steps) == 3
    assert len(qtab.evaluate(run, 2, seed=0).returns) == 2


@posix_only
@pytest.mark.parametrize(("kind", "algorithm"), CASES)
def test_a_stored_run_resumes_wherever_it_was_stopped(kind: str, algorithm: Any, tmp_path: Path) -> None:
    settings = {**settings_of(kind, algorithm), "episodes": 2_000_000, "seed": 1}
    stopped = stopped_by_a_timer(0.01, "CartPole-v1", **settings)
    episodes = len(stopped.episode_returns) + 2
    ending: Any = {"callback": lambda _: False, "callback_every": episodes}
    stopped.save(tmp_path / "run.npz")
    resumed = qtab.resume(qtab.load(tmp_path / "run.npz"), progress=False, **ending)
    whole = qtab.train("CartPole-v1", **settings, **ending)
    assert parts(resumed) == parts(whole)
    assert resumed.tables.tobytes() == whole.tables.tobytes()

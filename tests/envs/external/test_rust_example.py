"""The example in Rust: built by Cargo, and equal to the same environment in Python to the last bit."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import qtab
from support.native.libraries import EXAMPLES, build_rust, example_class, needs_cargo

pytestmark = [needs_cargo, pytest.mark.slow]
SETTINGS: dict[str, Any] = {"episodes": 40, "max_episode_steps": 56, "action_mask": True}


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_rust(EXAMPLES / "own_environment_rust", tmp_path_factory.mktemp("shop"), "shop")


@pytest.mark.parametrize("settings", [{}, {"algorithm": "dyna_q"}, {"algorithm": "sarsa_lambda"}], ids=str)
def test_the_numbers_are_those_of_python(shop: Path, settings: dict[str, Any]) -> None:
    in_python = example_class("own_environment_rust/shop.py", "Shop")()
    ours = qtab.train(qtab.NativeEnv(shop), seed=4, visits=True, **SETTINGS, **settings)
    theirs = qtab.train(in_python, seed=4, visits=True, **SETTINGS, **settings)
    assert (ours.config.backend, theirs.config.backend) == ("rust", "gymnasium")
    for name in ("episode_returns", "episode_lengths", "terminated", "tables", "visits"):
        assert getattr(ours, name).tobytes() == getattr(theirs, name).tobytes(), name


def test_its_generator_draws_as_numpy_does(shop: Path) -> None:
    """The stock and the day after a reset are ``integers(0, 13)`` and ``integers(0, 7)``."""
    env = qtab.NativeEnv(shop)
    for seed in range(50):
        observation, info = env.reset(seed=seed)
        rng = np.random.default_rng(seed)
        assert observation.tolist() == [rng.integers(0, 13), rng.integers(0, 7)]
        assert info["action_mask"].tolist() == [int(observation[0] + order <= 12) for order in range(9)]


def test_many_runs_on_threads_keep_their_masks(shop: Path) -> None:
    runs = qtab.train_many(lambda: qtab.NativeEnv(shop), seeds=6, threads=2, tables=True, **SETTINGS)
    assert runs.config.backend == "rust"
    assert runs.action_masks is not None
    for seed in range(6):
        one = qtab.train(qtab.NativeEnv(shop), seed=seed, **SETTINGS)
        assert one.tables.tobytes() == runs[seed].tables.tobytes()
        assert one.action_masks is not None
        assert one.action_masks.tobytes() == runs.action_masks[seed].tobytes()
        assert not one.action_masks.all()

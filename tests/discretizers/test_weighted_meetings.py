"""Weighted features where other parts of the package meet them: files of settings, threads, memory, several runs."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.cli.command import parser_of
from qtab.cli.commands.train import env_and_settings
from qtab.config.merge import merge
from qtab.config.options import WEIGHTED

CAR = "MountainCar-v0"
SHORT: dict[str, Any] = {"episodes": 3, "max_episode_steps": 30, "progress": False}


def config_of(path: Path, text: str, *flags: str) -> qtab.Config:
    """The config of ``qtab train --config FILE`` with some flags."""
    path.write_text(f'env = "{CAR}"\n{text}')
    env, settings = env_and_settings(parser_of("train", ["--config", str(path), *flags]).read())
    return merge(env, settings)


def test_a_file_of_settings_gives_the_rates_of_its_discretizer_and_of_the_flags(tmp_path: Path) -> None:
    path, radial = tmp_path / "run.toml", 'discretizer = "radial"\nnormalized = true\ncenters = [4, 3]\n'
    config = config_of(path, radial)
    assert (config.learning_rate, config.initial_q, config.centers) == (0.1, 0.0, (4, 3))
    assert config_of(path, radial, "--normalized", "False").learning_rate == 0.001
    assert config_of(path, f"{radial}learning_rate = 0.3\n", "--normalized", "False").learning_rate == 0.3
    assert config_of(path, "episodes = 5\n", "--discretizer", "fourier", "--preset", "solved").learning_rate == 0.001
    assert config_of(path, 'discretizer = "coarse"\n', "--discretizer", "tiles").learning_rate == 0.2
    with pytest.raises(ValueError, match=r"^normalized applies to discretizer 'radial', not to 'coarse', got True$"):
        config_of(path, radial, "--discretizer", "coarse")


@pytest.mark.parametrize("kind", WEIGHTED)
def test_threads_do_not_change_runs_and_their_memory_is_limited(kind: Any) -> None:
    one, two = (
        qtab.train_many(CAR, seeds=5, threads=threads, tables=True, discretizer=kind, **SHORT) for threads in (1, 2)
    )
    assert one.tables is not None
    assert two.tables is not None
    assert one.tables.tobytes() == two.tables.tobytes()
    with pytest.raises(MemoryError, match=r"^5 runs of 3 episodes would take .* more than memory_limit=3000 "):
        qtab.train_many(CAR, seeds=5, tables=True, discretizer=kind, memory_limit=3000, **SHORT)


@pytest.mark.parametrize("kind", WEIGHTED)
def test_several_runs_are_drawn_and_compared_with_the_optimum(kind: Any) -> None:
    plt = pytest.importorskip("matplotlib.pyplot")
    runs = qtab.train_many(CAR, seeds=2, tables=True, discretizer=kind, **SHORT)
    qtab.plots.values(runs)
    qtab.plots.policy(runs)
    qtab.plots.difference(next(iter(runs)), qtab.optimum(CAR))
    plt.close("all")


def test_values_are_estimated_with_features_of_your_own_as_the_refusal_says() -> None:
    def features(at: Any) -> Any:
        return np.array([(at[0] + 1.2) / 1.8, (at[0] + 1.2) / 1.8 * (at[1] + 0.07) / 0.14])

    def wrapped() -> gym.Env[Any, Any]:
        return gym.wrappers.TransformObservation(gym.make(CAR), features, gym.spaces.Box(0.0, 1.0, (2,), np.float64))

    with pytest.raises(ValueError, match=r"^features must be an array .* with order=1 and coupled=False$"):
        qtab.estimate_values(CAR, "random", features=features, learning_rate=0.1)
    own: dict[str, Any] = {"discretizer": "polynomial", "order": 1, "coupled": False, "max_episode_steps": 30}
    found = qtab.estimate_values(wrapped(), "random", method="lstd", episodes=3, **own)
    x = features([-0.5, 0.01])
    np.testing.assert_allclose(found.value(x), found.weights[:, -1] @ [1.0, *x], rtol=1e-12)
    assert found.verify(env=wrapped()).equal

"""Commands that make the environment of a saved run, which a package of the user registers."""

import sys
from collections.abc import Iterator
from pathlib import Path

import gymnasium as gym
import pytest

import qtab
from support.processes.command import qtab_here, refused

NAME = "ponds:OwnPond-v0"
COMMANDS = [("verify", "run.npz"), ("explain", "run.npz"), ("diagnose", "run.npz"), ("record", "run.npz", "lake.html")]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    (tmp_path / "ponds.py").write_text(
        "import gymnasium as gym\n"
        "gym.register('OwnPond-v0', 'gymnasium.envs.toy_text.frozen_lake:FrozenLakeEnv', max_episode_steps=50)\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    qtab.train(NAME, seed=0, episodes=3, progress=False).save(tmp_path / "run.npz")
    _forget()
    yield tmp_path
    _forget()


def _forget() -> None:
    sys.modules.pop("ponds", None)
    gym.registry.pop("OwnPond-v0", None)


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_the_environment_is_imported_by_its_package(folder: Path, command: tuple[str, ...]) -> None:
    if command[0] == "record":
        pytest.importorskip("pygame")
    expected = "--env must be that of the run, 'ponds:OwnPond-v0', got 'OwnPond-v0'"
    assert expected in refused(*command, "--env", "OwnPond-v0", cwd=folder)
    done = qtab_here(*command, "--env", NAME, cwd=folder)
    assert done.returncode == 0, done
    expected = "--env must be that of the run, 'ponds:OwnPond-v0', got 'Taxi-v4'"
    assert expected in refused(*command, "--env", "Taxi-v4", cwd=folder)


@pytest.mark.parametrize("command", ["verify", "explain", "record"])
def test_no_package_is_imported_for_the_name_in_a_file(folder: Path, command: str) -> None:
    given = next(one for one in COMMANDS if one[0] == command)
    assert "import ponds first, or pass --env" in refused(*given, cwd=folder)
    assert "ponds" not in sys.modules

"""``run.to_json``: the greedy policy as plain data, and the page whose NumPy follows it."""

import json
import re
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.config.options import WEIGHTED
from support.repository import ROOT

PAGE = (ROOT / "docs/how_to/export.md").read_text(encoding="utf-8")
PYTHON = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)

RUNS: dict[str, tuple[str, dict[str, Any]]] = {
    "article": ("MountainCar-v0", {}),
    "tiles": ("MountainCar-v0", {"discretizer": "tiles", "tiles": (5, 7), "tilings": 4}),
    "hashed tiles": ("MountainCar-v0", {"preset": "solved", "hashed_rows": 512}),
    "bins": ("CartPole-v1", {}),
    "edges": ("MountainCar-v0", {"discretizer": "edges", "edges": ((-0.9, -0.5, 0.1), (-0.01, 0.0, 0.02))}),
    "two tables": ("MountainCar-v0", {"algorithm": "double_q_learning"}),
    "a Box of actions": ("Pendulum-v1", {"actions": 5}),
    "discrete": ("FrozenLake-v1", {"env_kwargs": {"is_slippery": False}, "episodes": 2000}),
    "several integers": ("Blackjack-v1", {"episodes": 2000}),
    "missing actions": ("qtab/MaximizationBias-v0", {}),
    "action masks": ("Taxi-v4", {"action_mask": True, "episodes": 30}),
    "a Fourier basis": ("MountainCar-v0", {"discretizer": "fourier", "order": 4}),
    "uncoupled polynomials": ("MountainCar-v0", {"discretizer": "polynomial", "coupled": False}),
    "radial basis functions": ("MountainCar-v0", {"discretizer": "radial", "normalized": True, "width": (1, 0.7)}),
    "coarse coding, two tables": ("MountainCar-v0", {"discretizer": "coarse", "algorithm": "double_q_learning"}),
}


def section(name: str) -> list[str]:
    """The code blocks under a heading; those before the first heading come first."""
    return PYTHON.findall(PAGE.split(f"\n## {name}\n")[1].split("\n## ")[0])


def policy(path: Path) -> Any:
    """The function ``act`` of the page, for the file of a run."""
    blocks = PYTHON.findall(PAGE.split("\n## ")[0])
    assert len(blocks) == 2
    namespace: dict[str, Any] = {}
    exec(blocks[1].replace('"run.json"', repr(str(path))), namespace)  # noqa: S102 - our own page
    chosen = namespace["grid"]["type"]
    for block in section("Weighted features" if chosen in WEIGHTED else chosen):
        exec(block, namespace)  # noqa: S102 - our own page
    return namespace["act"]


def strict(path: Path) -> Any:
    def refused(word: str) -> None:
        raise AssertionError(word)

    return json.loads(path.read_text(encoding="utf-8"), parse_constant=refused)


@pytest.mark.parametrize("name", RUNS)
def test_the_pages_numpy_follows_the_policy_that_predict_follows(name, tmp_path):
    env_id, settings = RUNS[name]
    run = qtab.train(env_id, **{"episodes": 30, "seed": 0, "max_episode_steps": 100, **settings})
    path = tmp_path / "run.json"
    run.to_json(path)
    act = policy(path)
    space: Any = gym.make(env_id).observation_space
    space.seed(0)
    observations = [space.sample() for _ in range(60)]
    taken = []
    for observation in observations:
        if isinstance(space, gym.spaces.Box):
            observation = np.clip(observation, -5, 5)
        expected, _ = run.predict(observation)
        action = act(observation)
        taken.append(action)
        assert np.array_equal(np.array(action, getattr(expected, "dtype", None)), expected)
    assert len({str(action) for action in taken}) > 1 or name == "missing actions"


def test_the_file_holds_what_the_page_lists(tmp_path):
    run = qtab.train("MountainCar-v0", episodes=20, seed=3)
    path = tmp_path / "run.json"
    run.to_json(path)
    data = strict(path)
    listed = re.findall(r"`(\w+)`", "".join(re.findall(r"^\| (`.*?) \|", PAGE, re.MULTILINE)))
    assert list(data) == listed
    assert data["format"] == "qtab policy"
    assert data["version"] == 1
    assert (data["env"], data["seed"], data["episodes"]) == ("MountainCar-v0", 3, 20)
    assert data["shape"] == [19, 15]
    assert data["actions"] == [0, 1, 2]
    assert np.array(data["q_tables"]).tobytes() == run.tables.tobytes()
    before = path.read_bytes()
    run.to_json(str(path))
    assert path.read_bytes() == before


def test_an_action_that_a_state_does_not_have_is_null(tmp_path):
    run = qtab.train("qtab/MaximizationBias-v0", episodes=5, seed=0)
    assert np.isneginf(run.tables).any()
    run.to_json(tmp_path / "run.json")
    (table,) = strict(tmp_path / "run.json")["q_tables"]
    assert [[value is None for value in row] for row in table] == np.isneginf(run.tables[0]).tolist()


def test_an_action_that_a_mask_excludes_is_null(tmp_path):
    run = qtab.train("Taxi-v4", action_mask=True, episodes=5, seed=0)
    assert run.action_masks is not None
    assert not run.action_masks.all()
    run.to_json(tmp_path / "run.json")
    (table,) = strict(tmp_path / "run.json")["q_tables"]
    assert [[value is not None for value in row] for row in table] == run.action_masks.tolist()


def test_action_masks_with_tile_coding_are_refused(tmp_path):
    tiles: dict[str, Any] = {"discretizer": "tiles", "tiles": 4, "tilings": 2, "episodes": 2, "seed": 0}
    run = qtab.train("MountainCar-v0", action_mask=lambda _: [True, False, True], **tiles)
    with pytest.raises(ValueError, match="plain data holds the action masks of cells, not of tile coding"):
        run.to_json(tmp_path / "run.json")


def test_the_first_block_of_the_page_writes_the_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(PYTHON.findall(PAGE)[0], {})  # noqa: S102 - our own page
    assert strict(Path("run.json"))["discretizer"]["type"] == "tiles"


def test_what_json_does_not_have_is_refused(tmp_path):
    run = qtab.train("FrozenLake-v1", episodes=2, seed=0, env_kwargs={"reward_schedule": (float("inf"), 0, 0)})
    with pytest.raises(ValueError, match="env_kwargs must be JSON data"):
        run.to_json(tmp_path / "run.json")
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(OSError, match="path"):
        qtab.train("FrozenLake-v1", episodes=2, seed=0).to_json(tmp_path)


def test_actions_of_parts_are_lists_and_dicts(tmp_path):
    class Levers(gym.Env[Any, Any]):
        observation_space = gym.spaces.Discrete(1)
        action_space = gym.spaces.Dict(
            {"pair": gym.spaces.Tuple((gym.spaces.Discrete(2, start=3), gym.spaces.MultiBinary(1)))}
        )

        def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
            return 0, {}

        def step(self, action: Any) -> Any:
            return 0, 1.0, True, False, {}

    qtab.train(Levers(), episodes=1, seed=0, max_episode_steps=5).to_json(tmp_path / "run.json")
    pairs = [[3, [0]], [3, [1]], [4, [0]], [4, [1]]]
    assert strict(tmp_path / "run.json")["actions"] == [{"pair": pair} for pair in pairs]

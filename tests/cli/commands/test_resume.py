"""``qtab resume``: the same run as in Python, saved also on Ctrl-C, and refusals in one line."""

import json
import sys
from pathlib import Path
from typing import Any, ClassVar

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec

import qtab
from support.parity import assert_same_run
from support.processes.command import qtab_here, refused

LAKE = "FrozenLake-v1"


def stopped(path: Path, after: int = 4, **config: Any) -> qtab.Run:
    part = qtab.train(LAKE, callback=lambda progress: progress.episodes < after, callback_every=after, **config)
    part.save(path)
    return part


def test_it_finishes_a_run_in_its_file_with_its_visits_and_snapshots(tmp_path: Path) -> None:
    config: dict[str, Any] = {"seed": 0, "episodes": 200, "visits": True, "snapshots": 4}
    stopped(tmp_path / "run.npz", 120, **config)
    done = qtab_here("resume", "run.npz", cwd=tmp_path)
    assert done.returncode == 0, done
    assert done.stderr == ""
    header, *lines = done.stdout.splitlines()
    assert header == "FrozenLake-v1 in Rust, resumed after 120 of 200 episodes, seed 0"
    assert [line.split(" Average")[0] for line in lines if "Average" in line] == ["Episode 200"]
    assert lines[-1] == "Saved the run to run.npz"
    saved, whole = qtab.load(tmp_path / "run.npz"), qtab.train(LAKE, **config)
    assert_same_run(saved, whole)
    assert saved.visits is not None
    np.testing.assert_array_equal(saved.visits, whole.visits)
    assert saved.snapshots is not None
    assert saved.snapshots.episodes.tolist() == [50, 100, 150, 200]


def test_it_trains_longer_into_another_file(tmp_path: Path) -> None:
    part = stopped(tmp_path / "run.npz", seed=0, episodes=4)
    before = (tmp_path / "run.npz").read_bytes()
    arguments = ("--episodes", "9", "--save", "longer.npz", "--plot", "curve.png", "--snapshots", "3")
    done = qtab_here("resume", "run.npz", *arguments, "--json", cwd=tmp_path)
    assert done.returncode == 0, done
    assert json.loads(done.stdout)["files"] == {"save": "longer.npz", "plot": "curve.png"}
    assert (tmp_path / "run.npz").read_bytes() == before
    longer = qtab.load(tmp_path / "longer.npz")
    assert_same_run(longer, qtab.resume(part, 9))
    assert longer.snapshots is not None
    assert longer.snapshots.episodes.tolist() == [6, 9]


def test_verify_tells_how_to_compare_the_first_part_of_a_run_that_was_trained_longer(tmp_path: Path) -> None:
    qtab.resume(stopped(tmp_path / "run.npz", seed=0, episodes=4), 9).save(tmp_path / "longer.npz")
    answer = refused("verify", "longer.npz", cwd=tmp_path)
    assert answer.startswith("qtab verify: error: --episodes must be given for a run that was extended after 4")
    assert answer.rstrip().endswith("; --episodes=4 compares them")
    assert qtab_here("verify", "longer.npz", "--episodes=4", cwd=tmp_path).returncode == 0


class Interrupts(gym.Env[Any, Any]):
    """Ctrl-C comes after some steps."""

    left: ClassVar[float] = np.inf
    observation_space, action_space = gym.spaces.Discrete(3), gym.spaces.Discrete(2)

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        return 0, {}

    def step(self, action: Any) -> Any:
        type(self).left -= 1
        if self.left < 0:
            raise KeyboardInterrupt
        return int(action), 0.0, bool(self.np_random.random() < 0.3), False, {}


@pytest.mark.parametrize("output", [(), ("--json",), ("--quiet",)])
def test_ctrl_c_keeps_what_was_learned(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, output: tuple[str, ...]
) -> None:
    spec = EnvSpec("Interrupts-v0", lambda **_: Interrupts())
    monkeypatch.setitem(gym.registry, "Interrupts-v0", spec)
    qtab.train("Interrupts-v0", seed=0, episodes=3, progress=False).save(tmp_path / "run.npz")
    monkeypatch.setattr(Interrupts, "left", 40)
    done = qtab_here("resume", "run.npz", "--episodes", "500", *output, cwd=tmp_path)
    assert done.returncode == 130
    saved = qtab.load(tmp_path / "run.npz")
    assert 3 < len(saved.episode_returns) < 500
    if output == ("--json",):
        printed = json.loads(done.stdout)
        assert (printed["completed"], printed["episodes"]) == (False, len(saved.episode_returns))
        assert printed["files"] == {"save": "run.npz"}
    elif output == ("--quiet",):
        assert (done.stdout, done.stderr) == ("", "")
    else:
        assert f"Stopped after {len(saved.episode_returns)} of 500 episodes" in done.stdout
    monkeypatch.setattr(Interrupts, "left", np.inf)
    assert qtab_here("resume", "run.npz", "--quiet", cwd=tmp_path).returncode == 0
    assert qtab.load(tmp_path / "run.npz").completed


def test_the_user_names_the_package_of_an_environment_and_not_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "lakes.py").write_text(
        "import gymnasium as gym\ngym.register('OwnLake-v0', 'gymnasium.envs.toy_text.frozen_lake:FrozenLakeEnv')\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    qtab.train("lakes:OwnLake-v0", seed=0, episodes=3, progress=False).save(tmp_path / "run.npz")
    del sys.modules["lakes"], gym.registry["OwnLake-v0"]
    answer = refused("resume", "run.npz", "--episodes", "5", cwd=tmp_path)
    assert "'lakes:OwnLake-v0' is not registered with Gymnasium: import lakes first" in answer
    assert "lakes" not in sys.modules
    done = qtab_here("resume", "run.npz", "--episodes", "5", "--env", "lakes:OwnLake-v0", "--quiet", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(qtab.load(tmp_path / "run.npz").episode_returns) == 5
    del sys.modules["lakes"], gym.registry["OwnLake-v0"]


REFUSED = [
    ("--episodes 9 --checkpoint 0", "--checkpoint must be an integer of at least 1, got 0"),
    ("--episodes 3", "--episodes must be more than the 4 that the run has finished, got 3"),
    ("--episodes x", "--episodes must be an integer, got 'x'"),
    ("--episodes 9 --env Taxi-v4", "--env must be that of the run to resume, 'FrozenLake-v1', got 'Taxi-v4'"),
    ("--episodes 9 --snapshots -1", "--snapshots must be an integer of at least 0, got -1"),
    ("--episodes 9 --save none/run.npz", "--save must be a file that can be written, got 'none/run.npz'"),
    ("--episodes 9 --plot run.docx", "--plot must end in"),
    ("--episodes 9 --json --quiet", "--json must be given without --quiet"),
    ("--episods 9", "unknown option --episods (did you mean --episodes?)"),
]


@pytest.mark.parametrize(("arguments", "said"), REFUSED)
def test_refusals_are_one_line_and_leave_the_file(tmp_path: Path, arguments: str, said: str) -> None:
    stopped(tmp_path / "run.npz", seed=0, episodes=4)
    before = (tmp_path / "run.npz").read_bytes()
    answer = refused("resume", "run.npz", *arguments.split(), cwd=tmp_path)
    assert answer.startswith(f"qtab resume: error: {said}"), answer
    assert (tmp_path / "run.npz").read_bytes() == before


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("none.npz", "RUN must be a file that can be read, got 'none.npz': No such file"),
        ("toys.py", "'toys.py' is not a run file that this version of qtab can read"),
        ("many.npz", "RUN must have the state of its training"),
    ],
)
def test_what_is_no_run_to_resume_is_refused(tmp_path: Path, name: str, said: str) -> None:
    qtab.train_many(LAKE, seeds=1, episodes=2, tables=True)[0].save(tmp_path / "many.npz")
    assert refused("resume", name, "--episodes", "9", cwd=tmp_path).startswith(f"qtab resume: error: {said}")


def test_the_optimum_of_a_wrapped_environment_is_refused(tmp_path: Path) -> None:
    wrapped = gym.wrappers.ClipReward(gym.make(LAKE), 0.0, 0.5)
    qtab.train(wrapped, seed=0, episodes=2).save(tmp_path / "run.npz")
    assert "ClipReward" in refused("resume", "run.npz", "--episodes", "3", "--optimum", cwd=tmp_path)

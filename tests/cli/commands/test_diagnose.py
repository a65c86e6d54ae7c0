"""``qtab diagnose``."""

import json
from pathlib import Path

import qtab
from support.processes.command import qtab_here, refused


def test_it_reports_the_findings_and_tries_the_changes(tmp_path: Path) -> None:
    run = qtab.train("FrozenLake-v1", seed=0, epsilon=0.0, episodes=1000)
    run.save(tmp_path / "run.npz")
    done = qtab_here("diagnose", "run.npz", cwd=tmp_path)
    assert done.returncode == 0, done
    diagnosis = qtab.diagnose(run)
    assert done.stdout == f"{diagnosis}\n"
    done = qtab_here("diagnose", "run.npz", "--what-if", "--seeds", "3", cwd=tmp_path)
    assert done.stdout == f"{diagnosis}\n\n{diagnosis.what_if(3)}\n"


def test_the_return_of_the_greedy_policy_is_part_of_the_json_also_without_a_goal(tmp_path: Path) -> None:
    run = qtab.train("Pendulum-v1", seed=0, episodes=20)
    run.save(tmp_path / "run.npz")
    content = json.loads(qtab_here("diagnose", "run.npz", "--json", cwd=tmp_path).stdout)
    diagnosis = qtab.diagnose(run)
    assert content["goal_return"] is None
    assert diagnosis.facts.greedy is not None
    assert content["greedy_return"] == diagnosis.facts.greedy.returns.mean()


def test_a_file_that_is_missing_is_refused(tmp_path: Path) -> None:
    assert "none.npz" in refused("diagnose", "none.npz", cwd=tmp_path)

"""``qtab explain``."""

from pathlib import Path

import qtab
from support.processes.command import qtab_here, refused


def test_it_shows_the_steps_of_a_saved_run(tmp_path: Path) -> None:
    run = qtab.train("MountainCar-v0", seed=0, episodes=3)
    run.save(tmp_path / "run.npz")
    done = qtab_here("explain", "run.npz", "--episode", "2", "--steps", "3", "--start", "1", cwd=tmp_path)
    assert done.returncode == 0, done
    assert done.stdout == f"{qtab.explain(run, 2, 3, 1)}\n"
    assert "episode must be an integer from 0 to 2, got 3" in refused(
        "explain", "run.npz", "--episode", "3", cwd=tmp_path
    )

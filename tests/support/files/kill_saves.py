"""Kills processes that save a run again and again, and loads what they left each time.

python tests/support/files/kill_saves.py FOLDER KILLS
"""

import os
import signal
import sys
import time
from pathlib import Path

import numpy as np

import qtab


def main(folder: Path, kills: int) -> None:
    path = folder / "run.npz"
    initial_q = np.zeros((19, 15, 3))
    runs = [qtab.train("MountainCar-v0", seed=seed, episodes=2_000, initial_q=initial_q) for seed in (0, 1)]
    expected = {run.tables.tobytes() for run in runs}
    runs[0].save(path)
    start = time.perf_counter()
    runs[1].save(path)
    longest = 4 * (time.perf_counter() - start)
    delays = np.random.default_rng(0)
    interrupted = 0
    for _ in range(kills):
        child = os.fork()
        if child == 0:
            while True:
                for run in runs:
                    run.save(path)
        time.sleep(delays.uniform(0.0, longest))  # any moment of a save
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        interrupted += len(list(folder.iterdir())) > 1
        loaded = qtab.load(path)
        assert loaded.tables.tobytes() in expected
        assert not loaded.unchecked
    runs[0].save(path)
    left = [entry.name for entry in folder.iterdir()]
    assert left == ["run.npz"], left
    sys.stdout.write(f"{kills} kills, {interrupted} of which left a temporary file for the next save to remove\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))

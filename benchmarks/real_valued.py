"""The time per step of Sarsa with real-valued features on MountainCar-v0, beside tile coding and Numba."""

from typing import Any

import numpy as np

import qtab
from loops import numba_fourier, numba_loops
from loops.numba_fourier import LEARNING_RATE, ORDER
from tables import Benchmark, Column, Table, relative_time, relative_to

EPISODES = 300
SARSA: dict[str, Any] = {"algorithm": "sarsa", "discount": 1.0, "epsilon": 0.0, "initial_q": 0.0}
TILES, FOURIER = "Sarsa, 8 tilings", f"Sarsa, Fourier basis of order {ORDER}"
FEATURES: dict[str, dict[str, Any]] = {
    TILES: {"discretizer": "tiles", "tilings": 8, "tiles": 8, "learning_rate": 0.3},
    FOURIER: {"discretizer": "fourier", "order": ORDER, "learning_rate": LEARNING_RATE},
    "Sarsa, polynomials of order 5": {"discretizer": "polynomial", "order": 5, "learning_rate": 0.001},
    "Sarsa, 6 × 6 radial basis functions": {"discretizer": "radial", "centers": 6, "learning_rate": 0.003},
    "Sarsa, 6 × 6 circles": {"discretizer": "coarse", "centers": 6, "learning_rate": 0.005},
}
NUMBA, COSINES = f"{FOURIER}, under numba", f"{FOURIER}, under numba, by 36 cosines"


def learning() -> Table:
    """Returns the table of the features: single runs, and Numba's loops if Numba is installed."""
    loops = {name: _single({**SARSA, "episodes": EPISODES, **settings}) for name, settings in FEATURES.items()}
    if numba_loops.numba:
        loops |= {NUMBA: _numba(by_cosines=False), COSINES: _numba(by_cosines=True)}
    columns = [
        Column("rel. time", relative_to(TILES, [*loops]), relative_time),
        Column("× numba", {FOURIER: NUMBA}),
        Column("× cosines", {FOURIER: COSINES}),
    ]
    return Table("Real-valued features on MountainCar-v0", loops, columns)


def _single(settings: dict[str, Any]) -> Benchmark:
    return lambda seed: int(qtab.train("MountainCar-v0", seed=seed, progress=False, **settings).episode_lengths.sum())


def _numba(*, by_cosines: bool) -> Benchmark:
    def run(seed: int) -> int:
        starts = np.random.default_rng(seed).uniform(-0.6, -0.4, EPISODES)
        return int(numba_fourier.sarsa(starts, seed, by_cosines)[2])

    return run

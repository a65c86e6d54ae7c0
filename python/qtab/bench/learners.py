"""The time per step of the learners, relative to Q-learning on the article's grid and to numba."""

from typing import Any

from qtab.bench.sarsa_numba import EPISODES, TILES, TILINGS, compiled
from qtab.bench.timing import Benchmark, Timings
from qtab.training.train import train
from qtab.training.train_many import train_many

ENV = "MountainCar-v0"
TITLE = "Learners on MountainCar-v0"

CUTOFF = 1e-3
_TILES: dict[str, Any] = {"discretizer": "tiles", "tilings": TILINGS, "tiles": TILES, "episodes": EPISODES}
_TILES |= {"learning_rate": 0.3, "discount": 1.0, "epsilon": 0.0, "initial_q": 0.0}
_TRACES = {**_TILES, "algorithm": "sarsa_lambda", "trace_decay": 0.9}

Q_LEARNING = "Q-learning, the article's grid"
TRACES, CUT = "Sarsa(0.9), 8 tilings", "Sarsa(0.9), 8 tilings, trace_cutoff=1e-3"
SETTINGS: dict[str, dict[str, Any]] = {
    Q_LEARNING: {},
    "Sarsa, the same grid": {"algorithm": "sarsa"},
    "Expected Sarsa, the same grid": {"algorithm": "expected_sarsa"},
    "Q-learning, 8 tilings": _TILES,
    "Sarsa, 8 tilings": {**_TILES, "algorithm": "sarsa"},
    TRACES: _TRACES,
    CUT: {**_TRACES, "trace_cutoff": CUTOFF},
}
MANY = {f"{name}, train_many, 16 seeds, one thread": name for name in ("Q-learning, 8 tilings", "Sarsa, 8 tilings")}
"""Many runs on one core, by the name of the single run."""
NUMBA = {f"{name}, under numba": (name, cutoff) for name, cutoff in ((TRACES, 0.0), (CUT, CUTOFF))}


def training() -> dict[str, Benchmark]:
    """Returns the benchmarks: a run of each learner, many runs, and numba's loops if numba is installed."""
    loops = {name: compiled(0.9, cutoff) for name, (_, cutoff) in NUMBA.items()}
    single = {name: _single(settings) for name, settings in SETTINGS.items()}
    many = {name: _many(SETTINGS[of]) for name, of in MANY.items()}
    return single | many | {name: loop for name, loop in loops.items() if loop is not None}


def lines(timings: Timings) -> list[list[str]]:
    """Returns the rows of the table: name, nanoseconds per step, time relative to Q-learning, and speed to numba."""
    numba_names = {ours: name for name, (ours, _) in NUMBA.items() if name in timings.nanoseconds}
    rows = [name for name in (*SETTINGS, *MANY, *NUMBA) if name in timings.nanoseconds]
    return [
        [
            name,
            f"{timings.median(name):,.1f}",
            f"{timings.ratio(name, Q_LEARNING):.2f}",
            f"{timings.ratio(numba_names[name], name):.1f}" if name in numba_names else "",
        ]
        for name in rows
    ]


def _single(settings: dict[str, Any]) -> Benchmark:
    return lambda index: int(train(ENV, seed=index, progress=False, **settings).episode_lengths.sum())


def _many(settings: dict[str, Any]) -> Benchmark:
    return lambda _: int(train_many(ENV, 16, threads=1, progress=False, **settings).episode_lengths.sum())

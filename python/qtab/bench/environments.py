"""Training with the default presets of other environments than MountainCar."""

from qtab.bench import table_numba
from qtab.bench.plain_loop import q_learning
from qtab.bench.timing import Benchmark, Timings
from qtab.config.presets import presets
from qtab.training.train import train
from qtab.training.train_many import train_many

EPISODES = {"FrozenLake-v1": 400, "Taxi-v4": 40, "CartPole-v1": 100}
"""The episodes of the plain loop in a round; the schedules of the rates are compressed to them."""

TITLE = "Training, the environment's preset"
_METHODS = ("a plain loop: NumPy on gymnasium.make", "qtab.train", "train_many, 16 seeds, one thread")
METHODS = (*_METHODS, "train_many, 32 seeds, two threads")
FIRST = f"FrozenLake, {METHODS[0]}"
NUMBA = "a loop over the table under numba"
TABLES = ("FrozenLake-v1", "Taxi-v4")
"""The environments that have such a loop."""


def names() -> list[str]:
    """Returns the ids of the environments to train on."""
    return [name for name in EPISODES if presets(name)]


def training() -> dict[str, Benchmark]:
    """Returns the benchmarks of each environment: a plain loop, a single run, and many runs on one and two threads."""
    benchmarks: dict[str, Benchmark] = {}
    for name in names():
        loops = (_plain(name), _single(name), _many(name, 16, 1), _many(name, 32, 2))
        benchmarks |= {_row(name, method): loop for method, loop in zip(METHODS, loops, strict=True)}
        numba = table_numba.compiled(name) if name in TABLES else None
        if numba is not None:
            benchmarks[_row(name, NUMBA)] = numba
    return benchmarks


def lines(timings: Timings) -> list[list[str]]:
    """Returns the rows of the table: name, nanoseconds per step, and how many times as fast as the two loops."""
    rows = []
    for name in names():
        plain, numba = _row(name, METHODS[0]), _row(name, NUMBA)
        for row in (plain, numba, *(_row(name, method) for method in METHODS[1:])):
            if row in timings.nanoseconds:
                of_numba = f"{timings.ratio(numba, row):.1f}" if numba in timings.nanoseconds and row != plain else ""
                rows.append([row, f"{timings.median(row):,.1f}", f"{timings.ratio(plain, row):,.0f}", of_numba])
    return rows


def _row(name: str, method: str) -> str:
    return f"{name.partition('-')[0]}, {method}"


def _plain(name: str) -> Benchmark:
    return lambda index: q_learning(name, EPISODES[name], index)[1]


def _single(name: str) -> Benchmark:
    return lambda index: int(train(name, seed=index, progress=False).episode_lengths.sum())


def _many(name: str, seeds: int, threads: int) -> Benchmark:
    return lambda _: int(train_many(name, seeds, threads=threads, progress=False).episode_lengths.sum())

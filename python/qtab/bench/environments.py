"""Training with the default presets of other environments than MountainCar."""

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


def names() -> list[str]:
    """Returns the ids of the environments to train on."""
    return [name for name in EPISODES if presets(name)]


def training() -> dict[str, Benchmark]:
    """Returns the benchmarks of each environment: a plain loop, a single run, and many runs on one and two threads."""
    benchmarks: dict[str, Benchmark] = {}
    for name in names():
        loops = (_plain(name), _single(name), _many(name, 16, 1), _many(name, 32, 2))
        benchmarks |= {_row(name, method): loop for method, loop in zip(METHODS, loops, strict=True)}
    return benchmarks


def lines(timings: Timings) -> list[list[str]]:
    """Returns the rows of the table: name, nanoseconds per step, and how many times as fast as the plain loop."""
    groups = [[_row(name, method) for method in METHODS] for name in names()]
    return [
        [row, f"{timings.median(row):,.1f}", f"{timings.ratio(group[0], row):,.0f}"]
        for group in groups
        for row in group
    ]


def _row(name: str, method: str) -> str:
    return f"{name.partition('-')[0]}, {method}"


def _plain(name: str) -> Benchmark:
    return lambda index: q_learning(name, EPISODES[name], index)[1]


def _single(name: str) -> Benchmark:
    return lambda index: int(train(name, seed=index, progress=False).episode_lengths.sum())


def _many(name: str, seeds: int, threads: int) -> Benchmark:
    return lambda _: int(train_many(name, seeds, threads=threads, progress=False).episode_lengths.sum())

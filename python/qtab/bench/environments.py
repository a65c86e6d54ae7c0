"""Training on other environments than the article's, with the preset that each has."""

from qtab.bench.plain import q_learning
from qtab.bench.rounds import Subject, Timings
from qtab.config.presets import presets
from qtab.training.train import train
from qtab.training.train_many import train_many

EPISODES = {"FrozenLake-v1": 400, "Taxi-v4": 40, "CartPole-v1": 100}
"""A round of the plain loop: the whole schedule in so many episodes."""

TITLE = "Training, the environment's preset"
_WAYS = ("a plain loop: NumPy on gymnasium.make", "qtab.train", "train_many, 16 seeds, one thread")
WAYS = (*_WAYS, "train_many, 32 seeds, two threads")
FIRST = f"FrozenLake, {WAYS[0]}"


def names() -> list[str]:
    """Returns the environments that have a preset."""
    return [name for name in EPISODES if presets(name)]


def training() -> dict[str, Subject]:
    """Returns each environment's loops: a plain one, and this package's."""
    subjects: dict[str, Subject] = {}
    for name in names():
        loops = (_plain(name), _lone(name), _many(name, 16, 1), _many(name, 32, 2))
        subjects |= {_row(name, way): loop for way, loop in zip(WAYS, loops, strict=True)}
    return subjects


def lines(timings: Timings) -> list[list[str]]:
    """Returns each row: its name, nanoseconds a step, and how many times as fast as the plain loop."""
    rows = [[_row(name, way) for way in WAYS] for name in names()]
    return [
        [row, f"{timings.median(row):,.1f}", f"{timings.ratio(ways[0], row):,.0f}"] for ways in rows for row in ways
    ]


def _row(name: str, way: str) -> str:
    return f"{name.partition('-')[0]}, {way}"


def _plain(name: str) -> Subject:
    return lambda index: q_learning(name, EPISODES[name], index)[1]


def _lone(name: str) -> Subject:
    return lambda index: int(train(name, seed=index, progress=False).episode_lengths.sum())


def _many(name: str, seeds: int, threads: int) -> Subject:
    return lambda _: int(train_many(name, seeds, threads=threads).episode_lengths.sum())

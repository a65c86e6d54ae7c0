"""Running the benchmarks, and printing the results as tables."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from qtab._utils import checks
from qtab._utils.versions import versions
from qtab.bench import book, environments, learners, mountain_car, overhead, vector_envs
from qtab.bench.footprint import Footprint, footprint
from qtab.bench.timing import Benchmark, Timings, measure

DEFAULT_SECONDS = 25.0

PARTS: Mapping[str, Callable[[], dict[str, Benchmark]]] = {
    "training": mountain_car.training,
    "stepping": lambda: mountain_car.stepping() | overhead.python_stepping(),
    "vectors": lambda: (
        {mountain_car.QTAB_MAKE: mountain_car.stepping()[mountain_car.QTAB_MAKE]} | vector_envs.stepping()
    ),
    "environments": environments.training,
    "learners": learners.training,
    "book": book.training,
}
"""The groups of benchmarks, each of which can be run alone."""

_WIDTH = 55


@dataclass(frozen=True)
class Report:
    """The results of a bench run."""

    timings: Timings
    rounds: int
    footprint: Footprint
    versions: dict[str, str]

    def __str__(self) -> str:
        parts = {
            mountain_car.TRAIN: self._training,
            mountain_car.QTAB_STEP: self._stepping,
            vector_envs.SYNC: self._vectors,
            environments.FIRST: self._environments,
            learners.Q_LEARNING: self._learners,
            book.BANDIT: self._book,
        }
        lines = self._warning()
        for name, part in parts.items():
            if name in self.timings.nanoseconds:
                lines += [*part(), ""]
        lines += [*self._footprint(), ""]
        lines.append(
            f"{self.rounds} interleaved round{'' if self.rounds == 1 else 's'}; ns/step is the median over the rounds, "
            "× (times as fast) the median of their ratios"
        )
        lines.append(", ".join(f"{name} {value}" for name, value in self.versions.items()))
        return "\n".join(lines)

    def facts(self) -> dict[str, Any]:
        """Returns what ``qtab bench --json`` prints: for each benchmark the median, and the times of the rounds."""
        timings = self.timings
        return {
            "benchmarks": {
                name: {"ns_per_step": timings.median(name), "rounds": times}
                for name, times in timings.nanoseconds.items()
            },
            "rounds": self.rounds,
            "footprint": self.footprint,
            "versions": self.versions,
        }

    def _warning(self) -> list[str]:
        if self.versions["build"] == "release":
            return []
        return [f"WARNING: this is a {self.versions['build']} build, many times slower: maturin develop --release", ""]

    def _training(self) -> list[str]:
        timings = self.timings
        numba = mountain_car.NUMBA in timings.nanoseconds
        lines = [_line("Training on MountainCar-v0, default settings", "ns/step", "× article", *["× numba"] * numba)]
        bases = [mountain_car.ARTICLE, *[mountain_car.NUMBA] * numba]
        for name in mountain_car.TRAINING:
            if name in timings.nanoseconds:
                ratios = (_number(timings.ratio(base, name)) for base in bases)
                lines.append(_line(name, _number(timings.median(name)), *ratios))
        if not numba:
            lines.append("  (numba is not installed: pip install numba)")
        return lines

    def _stepping(self) -> list[str]:
        lines = [_line("Stepping MountainCar-v0 from Python", "ns/step", "× Gymnasium")]
        for base, name in (
            (mountain_car.GYMNASIUM_STEP, mountain_car.GYMNASIUM_STEP),
            (mountain_car.GYMNASIUM_STEP, mountain_car.QTAB_STEP),
            (mountain_car.GYMNASIUM_MAKE, mountain_car.GYMNASIUM_MAKE),
            (mountain_car.GYMNASIUM_MAKE, mountain_car.QTAB_MAKE),
        ):
            lines.append(_line(name, _number(self.timings.median(name)), _number(self.timings.ratio(base, name))))
        if overhead.LEARNING in self.timings.nanoseconds:
            lines.append(overhead.sentence(self.timings))
        return lines

    def _vectors(self) -> list[str]:
        rows = vector_envs.compared(self.timings)
        lines = [_line("Stepping many sub-environments", "ns/step", *(short for short, _ in vector_envs.BASES))]
        for name, ratios in rows:
            columns = ("" if ratio is None else _number(ratio) for ratio in ratios)
            lines.append(_line(name, _number(self.timings.median(name)), *columns))
        if vector_envs.ENVPOOL not in self.timings.nanoseconds:
            lines.append("  (EnvPool is not installed: pip install envpool)")
        return lines

    def _environments(self) -> list[str]:
        head = _line(environments.TITLE, "ns/step", "× plain loop", "× numba")
        return [head, *(_line(*columns) for columns in environments.lines(self.timings))]

    def _learners(self) -> list[str]:
        head = _line(learners.TITLE, "ns/step", "rel. time", "× numba")
        lines = [head, *(_line(*columns) for columns in learners.lines(self.timings))]
        return [*lines, "  (rel. time: relative to Q-learning on the grid)"]

    def _book(self) -> list[str]:
        head = _line(book.TITLE, "ns/step", "rel. time")
        lines = [head, *(_line(*columns) for columns in book.lines(self.timings))]
        return [*lines, "  (rel. time: relative to the first in the same environment)"]

    def _footprint(self) -> list[str]:
        cost = self.footprint
        lines = [
            f"import qtab adds {cost.qtab_milliseconds:.1f} ms to the {cost.gymnasium_milliseconds:.0f} ms of "
            "import gymnasium"
        ]
        if cost.megabytes is not None:
            added = f"{cost.megabytes:.1f} MB" if cost.megabytes >= 0.1 else "less than 0.1 MB"
            lines.append(f"a default run adds {added} to the peak memory after the imports")
        return lines


def bench(
    seconds: float = DEFAULT_SECONDS,
    rounds: int | None = None,
    progress: bool | None = None,
    part: str | None = None,
) -> Report:
    """Times training and stepping, and compares them with the article's loop and with Gymnasium.

    Args:
        seconds: The approximate duration of all rounds.
        rounds: The number of rounds; None derives it from ``seconds``.
        progress: Whether to show a progress bar; None shows one on a terminal.
        part: One of :data:`PARTS`; None runs all of them.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or an unknown part.
    """
    seconds = checks.real("seconds", seconds, 0, 86_400)
    if rounds is not None:
        rounds = checks.integer("rounds", rounds, least=1)
    if part is not None:
        part = checks.choice("part", part, PARTS)
    measured_footprint = footprint()
    benchmarks: dict[str, Benchmark] = {}
    for name, make in PARTS.items():
        if part in (None, name):
            benchmarks |= make()
    timings = measure(benchmarks, seconds=seconds, rounds=rounds, progress=progress)
    return Report(timings, len(next(iter(timings.nanoseconds.values()))), measured_footprint, versions())


def _line(name: str, *columns: str) -> str:
    return f"{name:{_WIDTH}}" + "".join(f"{column:>13}" for column in columns)


def _number(value: float) -> str:
    if value < 1:
        return f"{value:.2g}"
    return f"{value:,.1f}" if value < 100 else f"{value:,.0f}"

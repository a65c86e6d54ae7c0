"""The bench and its tables."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from qtab._utils import checks
from qtab._utils.versions import versions
from qtab.bench import environments, learners, overhead, subjects, vectors
from qtab.bench.footprint import Footprint, footprint
from qtab.bench.rounds import Subject, Timings, measure

DEFAULT_SECONDS = 25.0

PARTS: Mapping[str, Callable[[], dict[str, Subject]]] = {
    "training": subjects.training,
    "stepping": lambda: subjects.stepping() | overhead.python_stepping(),
    "vectors": lambda: {subjects.QTAB_MAKE: subjects.stepping()[subjects.QTAB_MAKE]} | vectors.stepping(),
    "environments": environments.training,
    "learners": learners.training,
}
"""What may be timed by itself."""

_WIDTH = 55


@dataclass(frozen=True)
class Report:
    """What a bench found."""

    timings: Timings
    rounds: int
    footprint: Footprint
    versions: dict[str, str]

    def __str__(self) -> str:
        """Tables for a person."""
        parts = {
            subjects.TRAIN: self._training,
            subjects.QTAB_STEP: self._stepping,
            vectors.SYNC: self._vectors,
            environments.FIRST: self._environments,
            learners.Q_LEARNING: self._learners,
        }
        lines = self._warning()
        for subject, part in parts.items():
            if subject in self.timings.nanoseconds:
                lines += [*part(), ""]
        lines += [*self._footprint(), ""]
        lines.append(
            f"{self.rounds} interleaved rounds; ns/step is a median, × (times as fast) the median of each round's ratio"
        )
        lines.append(", ".join(f"{name} {value}" for name, value in self.versions.items()))
        return "\n".join(lines)

    def _warning(self) -> list[str]:
        if self.versions["build"] == "release":
            return []
        return [f"WARNING: this is a {self.versions['build']} build, many times slower: maturin develop --release", ""]

    def _training(self) -> list[str]:
        timings = self.timings
        numba = subjects.NUMBA in timings.nanoseconds
        lines = [_line("Training on MountainCar-v0, default settings", "ns/step", "× article", *["× numba"] * numba)]
        for name in (subjects.ARTICLE, subjects.NUMBA, subjects.TRAIN, subjects.MANY, subjects.MANY_ON_TWO):
            if name in timings.nanoseconds:
                ratios = [subjects.ARTICLE, *[subjects.NUMBA] * numba]
                lines.append(
                    _line(name, _number(timings.median(name)), *(_number(timings.ratio(base, name)) for base in ratios))
                )
        if not numba:
            lines.append("  (numba is not installed: pip install 'qtab[bench]')")
        return lines

    def _stepping(self) -> list[str]:
        lines = [_line("Stepping MountainCar-v0 from Python", "ns/step", "× Gymnasium")]
        for base, name in (
            (subjects.GYMNASIUM_STEP, subjects.GYMNASIUM_STEP),
            (subjects.GYMNASIUM_STEP, subjects.QTAB_STEP),
            (subjects.GYMNASIUM_MAKE, subjects.GYMNASIUM_MAKE),
            (subjects.GYMNASIUM_MAKE, subjects.QTAB_MAKE),
        ):
            lines.append(_line(name, _number(self.timings.median(name)), _number(self.timings.ratio(base, name))))
        if overhead.LEARNING in self.timings.nanoseconds:
            lines.append(overhead.sentence(self.timings))
        return lines

    def _vectors(self) -> list[str]:
        rows = vectors.compared(self.timings)
        lines = [_line("Stepping many sub-environments", "ns/step", *(short for short, _ in vectors.BASES))]
        for name, ratios in rows:
            columns = ("" if ratio is None else _number(ratio) for ratio in ratios)
            lines.append(_line(name, _number(self.timings.median(name)), *columns))
        if vectors.ENVPOOL not in self.timings.nanoseconds:
            lines.append("  (EnvPool is not installed: pip install envpool)")
        return lines

    def _environments(self) -> list[str]:
        head = _line(environments.TITLE, "ns/step", "× plain loop")
        return [head, *(_line(*columns) for columns in environments.lines(self.timings))]

    def _learners(self) -> list[str]:
        head = _line(learners.TITLE, "ns/step", "its time", "× numba")
        lines = [head, *(_line(*columns) for columns in learners.lines(self.timings))]
        return [*lines, "  (its time: how many times that of Q-learning on the grid)"]

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
    """Times training and stepping beside the article's loop and Gymnasium.

    Args:
        seconds: About how long the rounds take together.
        rounds: How many rounds to make instead.
        progress: Whether to show a bar; None shows one on a terminal.
        part: One of :data:`PARTS`; None times them all.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or an unknown part.
    """
    seconds = checks.real("seconds", seconds, 0, 86_400)
    if rounds is not None:
        rounds = checks.integer("rounds", rounds, least=1)
    if part is not None and part not in PARTS:
        raise ValueError(f"part must be one of {', '.join(map(repr, PARTS))}, got {part!r}")
    cost = footprint()
    timed: dict[str, Subject] = {}
    for name, make in PARTS.items():
        if part in (None, name):
            timed |= make()
    timings = measure(timed, seconds=seconds, rounds=rounds, progress=progress)
    return Report(timings, len(next(iter(timings.nanoseconds.values()))), cost, versions())


def _line(name: str, *columns: str) -> str:
    return f"{name:{_WIDTH}}" + "".join(f"{column:>13}" for column in columns)


def _number(value: float) -> str:
    if value < 1:
        return f"{value:.2g}"
    return f"{value:,.1f}" if value < 100 else f"{value:,.0f}"

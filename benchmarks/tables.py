"""The table of a group of benchmarks: nanoseconds per step, and how the benchmarks compare with each other.

Ratios are computed within each round, in which all benchmarks of a table take turns; a table of minima has ratios of
minima. pytest-benchmark and pyperf time
one benchmark after another, and asv interleaves only processes, each of which would compile Numba's loops again.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from qtab.cli.commands.bench import measure

Benchmark = Callable[[int], int]
"""Runs one round, given its number, and returns the number of environment steps."""
Times: TypeAlias = NDArray[np.float64]
"""(rounds,): nanoseconds per step."""


def speed_up(times: Times, base: Times) -> Times:
    """Returns the speed-up of a benchmark over its base, in each round."""
    return base / times


def relative_time(times: Times, base: Times) -> Times:
    """Returns the time of a benchmark relative to its base, in each round."""
    return times / base


def added_time(times: Times, base: Times) -> Times:
    """Returns the nanoseconds per step that a benchmark takes in addition to its base, in each round."""
    return times - base


@dataclass(frozen=True)
class Column:
    """A column that compares benchmarks with others."""

    head: str
    bases: Mapping[str, str]
    """For each benchmark with an entry in the column, its base: the benchmark that it is compared with."""
    compare: Callable[[Times, Times], Times] = speed_up


@dataclass(frozen=True)
class Table:
    """Benchmarks that are timed in the same rounds."""

    title: str
    benchmarks: Mapping[str, Benchmark]
    columns: Sequence[Column]
    minimum: bool = False
    """Whether to show the minimum of the rounds and ratios of minima, instead of medians."""

    def measured(self, seconds: float, rounds: int | None) -> str:
        """Runs the benchmarks and returns the table as text. See :func:`qtab.cli.commands.bench.measure`."""
        return self.text(measure(self.benchmarks, seconds, rounds))

    def text(self, times: Mapping[str, Times]) -> str:
        """Returns the table of benchmarks with these times."""
        if self.minimum:
            times = {name: row.min(keepdims=True) for name, row in times.items()}
        lines = [line(self.title, "ns/step", *(column.head for column in self.columns))]
        for name, row in times.items():
            cells = [self._cell(column, name, times) for column in self.columns]
            lines.append(line(name, number(row), *cells))
        return "\n".join(lines)

    def _cell(self, column: Column, name: str, times: Mapping[str, Times]) -> str:
        base = column.bases.get(name)
        return "" if base is None or base not in times else number(column.compare(times[name], times[base]))


def relative_to(base: str, names: Sequence[str]) -> dict[str, str]:
    """Returns the bases of a column in which these benchmarks are compared with a single one."""
    return dict.fromkeys(names, base)


def line(name: str, *columns: str) -> str:
    """Returns a line of a table."""
    return f"{name:55}{''.join(f'{column:>13}' for column in columns)}".rstrip()


def number(values: Times | float) -> str:
    """Returns the median of some numbers as text."""
    median = float(np.median(values))
    if abs(median) < 1:
        return f"{median:.2g}"
    return f"{median:,.1f}" if median < 100 else f"{median:,.0f}"

"""The largest eligibility traces of an update."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from qtab.explanation.records import Trace

SHOWN_TRACES = 8
"""The number of traces of a step that are kept, the largest ones."""

Table = NDArray[np.float64]


def largest_traces(
    z: Table,
    values: Table,
    cell: Callable[[int], tuple[int, ...] | None],
) -> tuple[tuple[Trace, ...], int]:
    """Returns the largest traces before an update, whose ``after`` is NaN, and the number of all nonzero traces.

    Args:
        z: (rows, actions): the traces.
        values: (rows, actions): the values before the update.
        cell: Returns the cell of a row.
    """
    traced = np.argwhere(z != 0.0)
    order = np.argsort(-np.abs(z[z != 0.0]), kind="stable")[:SHOWN_TRACES]
    found = tuple(
        Trace(row, cell(row), action, float(z[row, action]), float(values[row, action]), float("nan"))
        for row, action in traced[order].tolist()
    )
    return found, len(traced)


def changed(traces: tuple[Trace, ...], values: Table) -> tuple[Trace, ...]:
    """Returns the traces with the values after the update."""
    return tuple(replace(trace, after=float(values[trace.row, trace.action])) for trace in traces)

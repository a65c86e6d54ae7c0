"""Figure 8.7: expected and sample updates."""

import numpy as np

from qtab.book.drawing import draw_lines
from qtab.book.experiment import ExactExperiment
from qtab.book.line import Line, exact_line

BRANCHING = (2, 10, 100, 1_000, 10_000)
EXPECTED = "expected updates"
POINTS = 200
"""The largest number of points of a line."""


def _compute() -> list[Line]:
    # An expected update takes b computations, and is then exact.
    expected = exact_line(EXPECTED, [0.0, 1.0, 1.0, 2.0], [1.0, 1.0, 0.0, 0.0])
    return [_sample_updates(branching) for branching in BRANCHING] + [expected]


def _sample_updates(branching: int) -> Line:
    """Returns the error after t sample updates, √((b - 1) / (b t)), or 1 before the first one."""
    updates = np.unique(np.rint(np.linspace(1, 2 * branching, min(POINTS, 2 * branching))))
    errors = np.sqrt((branching - 1) / (branching * updates))
    return exact_line(f"b = {branching:,}", np.append(0.0, updates / branching), np.append(1.0, errors))


EXPERIMENT = ExactExperiment(
    name="figure-8.7",
    title="the error of expected and sample updates",
    book="b equally likely next states, whose values are correct; the initial error is 1; sample updates with step "
    "sizes 1/t have an error of √((b - 1) / (b t)) after t of them",
    unspecified="",
    compute=_compute,
    draw=draw_lines,
    names=(*(f"b = {branching:,}" for branching in BRANCHING), EXPECTED),
    x_label="number of computations of max Q(s', a'), in units of b",
    y_label="RMS error of the value",
    table_x=(0.0, 0.5, 1.0, 2.0),
    y_range=(0, 1.05),
)

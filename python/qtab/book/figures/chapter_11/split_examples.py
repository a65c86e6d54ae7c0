"""Examples 11.2 and 11.3: where the TD error and the Bellman error are smallest, and what the values are."""

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from qtab.book.experiment import ExactExperiment
from qtab.book.line import Line, exact_line
from qtab.envs.tabular import TabularEnv, Transition
from qtab.prediction.linear import LinearGeometry, linear_geometry
from qtab.prediction.linear.geometry import Objective

TRUE, FIXED_POINT = "true values", "TD fixed point"
MINIMA: dict[str, Objective] = {"smallest TD error": "td_error", "smallest Bellman error": "bellman_error"}
NAMES = (TRUE, FIXED_POINT, *MINIMA)


def _geometry(rows: Sequence[Sequence[Transition]], start: ArrayLike, features: ArrayLike) -> LinearGeometry:
    return linear_geometry(TabularEnv([[row] for row in rows], start), "random", features)


def a_split() -> LinearGeometry:
    """Returns Example 11.2: A leads to B or C with equal probability; B ends with a reward of 1, and C with 0."""
    rows = [[(0.5, 1, 0.0, False), (0.5, 2, 0.0, False)], [(1.0, 1, 1.0, True)], [(1.0, 2, 0.0, True)]]
    return _geometry(rows, [1.0, 0.0, 0.0], np.eye(3))


def a_presplit() -> LinearGeometry:
    """Returns Example 11.3: the chance comes first. A1 leads to B and A2 to C; A1 and A2 share a feature."""
    rows = [[(1.0, 2, 0.0, False)], [(1.0, 3, 0.0, False)], [(1.0, 2, 1.0, True)], [(1.0, 3, 0.0, True)]]
    return _geometry(rows, [0.5, 0.5, 0.0, 0.0], np.eye(3)[[0, 0, 1, 2]])


def _lines(geometry: LinearGeometry) -> list[Line]:
    weights = {FIXED_POINT: geometry.td_fixed_point} | {name: geometry.minimizer(one) for name, one in MINIMA.items()}
    values = {TRUE: geometry.values} | {name: geometry.values_of(w) for name, w in weights.items()}
    states = np.arange(1, len(geometry.values) + 1)
    lines = [exact_line(name, states, np.round(points, 12)) for name, points in values.items()]
    # The true values are below the others, which coincide with them at many points.
    return [dataclasses.replace(lines[0], broad=True), *lines[1:-1], dataclasses.replace(lines[-1], dashed=True)]


def _example(
    number: str, title: str, book: str, make: Callable[[], LinearGeometry], states: Sequence[str]
) -> ExactExperiment:
    words: dict[float, str] = dict(enumerate(states, start=1))
    return ExactExperiment(
        name=f"example-{number}",
        title=title,
        book=book,
        unspecified="",
        compute=lambda: _lines(make()),
        names=NAMES,
        x_label="state",
        y_label="value",
        x_ticks=tuple(words),
        x_words=words,
    )


EXAMPLE_11_2 = _example(
    "11.2",
    "A-split, and the naive residual-gradient algorithm",
    "from A to B or C with equal probability, then a reward of 1 from B and 0 from C, and the end; the smallest TD "
    "error is at the values 1/2, 3/4 and 1/4",
    a_split,
    ("A", "B", "C"),
)
EXAMPLE_11_3 = _example(
    "11.3",
    "A-presplit, and the values of the residual-gradient algorithm",
    "from A1 to B or from A2 to C, with equal probability, then as in Example 11.2; A1 and A2 share a feature; the "
    "smallest Bellman error is at the values 1/2, 3/4 and 1/4",
    a_presplit,
    ("A1", "A2", "B", "C"),
)

"""Figure 4.2: the policies of policy iteration for Jack's car rental."""

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.drawing import figure_of_several
from qtab.book.experiment import ExactExperiment
from qtab.book.figures.grid import as_grid
from qtab.book.line import Line, exact_line
from qtab.book.result import Result
from qtab.envs.book.jacks_car_rental import MAX_MOVED, cars_moved, jacks_car_rental
from qtab.planning.sweeps import policy_iteration

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CARS = 20
DISCOUNT = 0.9
POLICIES = tuple(f"π{index}" for index in range(5))
VALUES = f"value of {POLICIES[-1]}"
NO_MOVES = MAX_MOVED
"""The action that moves no car."""


def _compute() -> list[Line]:
    env = jacks_car_rental(CARS)
    steps = list(policy_iteration(env, DISCOUNT, policy=NO_MOVES))
    cells = range(len(steps[0].policy))
    moved = [[cars_moved(*divmod(cell, CARS + 1), int(step.policy[cell]), CARS) for cell in cells] for step in steps]
    lines = [exact_line(name, cells, one) for name, one in zip(POLICIES, moved, strict=True)]
    return [*lines, exact_line(VALUES, cells, steps[-1].values)]


def _text(lines: Sequence[Line]) -> str:
    *policies, values = lines
    last, grid = as_grid(policies[-1]), as_grid(values)
    rows = ["".join(f"{number:3.0f}" for number in row) for row in last[::-1]]
    changed = [
        f"{line.name}: {int((line.mean != before.mean).sum())} of {len(line.mean)} states changed"
        for before, line in pairwise(policies)
    ]
    return "\n".join(
        [
            *changed,
            f"{policies[-1].name}: cars moved from the first location to the second, by the cars at the first (up) and "
            "at the second (right)",
            *rows,
            f"{values.name}: from {grid.min():.1f} to {grid.max():.1f}",
        ]
    )


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    *policies, values = result.lines
    figure = figure_of_several(result, ax, 10, 6.5)
    image: Any = None
    panels = []
    for index, line in enumerate(policies):
        panel: Any = figure.add_subplot(2, 3, index + 1)
        edges = np.arange(2 * MAX_MOVED + 2) - MAX_MOVED - 0.5
        image = panel.pcolormesh(as_grid(line), cmap="RdBu", vmin=edges[0], vmax=edges[-1])
        # The book draws the lines between the numbers of moved cars.
        middle = np.arange(CARS + 1) + 0.5
        panel.contour(middle, middle, as_grid(line), levels=edges, colors="0.2", linewidths=0.6)
        panel.set_title(line.name, fontsize="medium")
        panel.set(xlabel="cars at the second location", ylabel="cars at the first location", aspect="equal")
        ticks = np.arange(0, CARS + 1, 5)
        panel.set_xticks(ticks + 0.5, ticks)
        panel.set_yticks(ticks + 0.5, ticks)
        panels.append(panel)
    bar = figure.colorbar(image, ax=panels[2:3], ticks=range(-MAX_MOVED, MAX_MOVED + 1))
    bar.set_label("cars moved to the second location")
    surface: Any = figure.add_subplot(2, 3, 6, projection="3d")
    second, first = np.meshgrid(np.arange(CARS + 1), np.arange(CARS + 1))
    surface.plot_surface(first, second, as_grid(values), cmap="viridis", linewidth=0)
    surface.set_title(values.name, fontsize="medium")
    surface.set(xlabel="first location", ylabel="second location")
    surface.tick_params(labelsize="x-small")
    last: Axes = surface
    return last


EXPERIMENT = ExactExperiment(
    name="figure-4.2",
    title="policy iteration for Jack's car rental",
    book="at most 20 cars at each location, at most 5 moved overnight for $2 each, $10 for each car rented; requests "
    "have means of 3 and 4 a day, returns of 3 and 2; γ = 0.9; the first policy never moves a car",
    unspecified="which of several best actions is taken (here the one that moves most cars to the first location)",
    compute=_compute,
    draw=_draw,
    names=(*POLICIES, VALUES),
    text=_text,
    x_label="state",
    y_label="cars moved",
)

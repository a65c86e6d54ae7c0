"""Section 9.5.2: the Fourier basis and other bases on Mountain Car, after Konidaris' comparison, which the book cites.

The article is G. Konidaris, S. Osentoski and P. Thomas, "Value function approximation in reinforcement learning using
the Fourier basis", AAAI 2011.
"""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from qtab.book.drawing import Panel, draw_panels
from qtab.book.line import Line
from qtab.book.measured_experiment import TrainingExperiment
from qtab.book.problems import ENV, TILE_CODING
from qtab.book.result import Result
from qtab.book.setting import Setting, lengths

if TYPE_CHECKING:
    from matplotlib.axes import Axes

METHOD: Mapping[str, Any] = {"algorithm": "sarsa_lambda", "trace_decay": 0.9, "episodes": 100}
"""The learner and its episodes, which all bases share."""
COMMON: Mapping[str, Any] = {
    name: value for name, value in TILE_CODING.items() if name not in ("discretizer", "tilings", "tiles")
}
"""The settings of the book's other experiments on Mountain Car, without those of tile coding."""
FOURIER, RADIAL, POLYNOMIALS, TILES = "Fourier basis", "radial basis functions", "polynomials", "8 tilings"
RATES: Mapping[int, float] = {3: 0.02, 5: 0.03, 7: 0.03}
"""The step size of the Fourier basis by order."""
WIDTHS: Mapping[int, tuple[float, float]] = {3: (0.5, 0.05), 5: (1.5, 0.01), 7: (2.0, 0.005)}
"""The width of as many radial basis functions, in distances between their centers, and their step size."""
POLYNOMIAL_RATE = 1e-5
POLYNOMIAL_RUNS = 10
"""Polynomials do not learn, so that each run takes thirty times as many steps as the others, far above the figure."""


def _settings() -> Iterator[Setting]:
    for order, rate in RATES.items():
        width, radial_rate = WIDTHS[order]
        count = (order + 1) ** 2
        fourier = {"discretizer": "fourier", "order": order, "learning_rate": rate}
        radial = {"discretizer": "radial", "centers": order + 1, "width": width, "learning_rate": radial_rate}
        powers = {"discretizer": "polynomial", "order": order, "learning_rate": POLYNOMIAL_RATE}
        yield _setting(f"{FOURIER}, order {order}, α = {rate:g}", FOURIER, fourier)
        yield _setting(f"{count} {RADIAL}, width {width:g}, α = {radial_rate:g}", RADIAL, radial)
        polynomials = _setting(f"{POLYNOMIALS}, order {order}, α = 1e-5", POLYNOMIALS, powers)
        yield dataclasses.replace(polynomials, max_runs=POLYNOMIAL_RUNS, drawn=False)
    tiles = {name: TILE_CODING[name] for name in ("discretizer", "tilings", "tiles")}
    tiles |= {"learning_rate": 1.1, "traces": "replacing"}
    yield dataclasses.replace(_setting(f"{TILES}, α = 1.1/8", TILES, tiles), dashed=True)


def _setting(line: str, method: str, basis: Mapping[str, Any]) -> Setting:
    return Setting(line, ENV, {**COMMON, **METHOD, "traces": "accumulating", **basis}, lengths, method=method)


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    *bases, tiles = result.lines
    panels = [
        Panel(f"order {order}, {(order + 1) ** 2} features", _named([*bases[first : first + 3], tiles]))
        for order, first in zip(RATES, range(0, len(bases), 3), strict=True)
    ]
    return draw_panels(result, ax, panels, shared_x=True)


def _named(lines: Sequence[Line]) -> list[Line]:
    """Returns the lines with the names of their bases alone: the title of their panel has the order."""
    return [dataclasses.replace(line, name=line.method) for line in lines]


EXPERIMENT = TrainingExperiment(
    name="section-9.5.2",
    title="the Fourier basis and other bases on Mountain Car",
    book="no figure; the book says that Fourier features with Sarsa can perform well compared with polynomials and "
    "radial basis functions, and cites Konidaris, Osentoski & Thomas (2011), who compare bases of equal size by "
    "Sarsa(λ)",
    unspecified="everything else: λ = 0.9, γ = 1 and ε = 0; accumulating traces, for 8 tilings replacing ones; initial "
    f"weights of zero; 100 episodes, 100 runs ({POLYNOMIAL_RUNS} with polynomials). The values of α are those with the "
    "fewest steps per episode in 20 other runs, among 0.002, 0.005, 0.01, 0.02, 0.03, 0.05 and 0.1 for the Fourier "
    "basis and radial basis functions, and among 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 1.1, 1.3 and 1.6, divided by 8, for "
    "tile coding. The width of radial basis functions was chosen in the same way, among 0.5, 1, 1.5 and 2 distances "
    "between their centers. Polynomials learn with none of ten step sizes from 1e-6 to 0.3",
    settings=tuple(_settings()),
    runs=100,
    x_label="episode",
    y_label="steps per episode",
    draw=_draw,
    table_x=(1, 2, 5, 10, 20, 50, 100),
    log_y=True,
    y_range=(100, 1500),
)

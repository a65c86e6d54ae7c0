"""Figure 9.8: how the width of features affects what coarse coding learns, early and in the long run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab.book.drawing import figure_of_several, line_colors
from qtab.book.experiment import ComputedExperiment
from qtab.book.line import Line, LineStyle, line_from_samples
from qtab.book.result import Result, aligned
from qtab.book.runner import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTHS: Mapping[str, float] = {"narrow": 0.1, "medium": 0.2, "broad": 0.5}
"""The width of the intervals as a part of the extent of the function, [0, 1]."""
EXAMPLES = (10, 40, 160, 640, 2560, 10240)
DENSITY = 50
"""The number of features over the extent."""
POINTS = (np.arange(200) + 0.5) / 200
"""Where the functions are drawn and measured."""
DESIRED = "desired function"
RANGE = (-0.4, 1.4)
"""The values that the figure shows."""


def square_wave(s: FloatArray) -> FloatArray:
    """Returns the desired function: 1 in the middle half of the extent, else 0."""
    wave: FloatArray = np.where((s > 0.25) & (s < 0.75), 1.0, 0.0)
    return wave


def interval_features(s: FloatArray, width: float) -> FloatArray:
    """Returns (..., d): 1 for each interval that contains s, else 0.

    The centers are equally spaced, up to half a width beyond the extent, so that every s is in equally many intervals.
    """
    count = round(DENSITY * (1.0 + width))
    centers = (np.arange(count) + 0.5) / DENSITY - width / 2
    features: FloatArray = (np.abs(s[..., np.newaxis] - centers) < width / 2).astype(np.float64)
    return features


def learned(width: float, examples: FloatArray, record: Sequence[int]) -> FloatArray:
    """Returns (points, places): the function after some numbers of examples, by w <- w + α [U - wᵀx] x (equation 9.7).

    The step size is 0.2 / n for n features that contain the example.
    """
    drawn = interval_features(POINTS, width)
    w, kept = np.zeros(drawn.shape[1]), []
    for number, (x, target) in enumerate(
        zip(interval_features(examples, width), square_wave(examples).tolist(), strict=True), 1
    ):
        w += 0.2 / x.sum() * (target - w @ x) * x
        if number in record:
            kept.append(drawn @ w)
    return np.array(kept)


@dataclass(frozen=True, kw_only=True, repr=False)
class CoarseCoding(ComputedExperiment):
    """The functions learned with each width, from the same examples."""

    def lines(self, seed: int) -> Sequence[Line]:
        """Computes the lines."""
        examples = np.random.default_rng(seed).random(EXAMPLES[-1])
        wave = line_from_samples(DESIRED, POINTS, square_wave(POINTS)[np.newaxis], style=LineStyle(dashed=True))
        found = {name: learned(width, examples, EXAMPLES) for name, width in WIDTHS.items()}
        return [
            wave,
            *(
                line_from_samples(_line_name(name, count), POINTS, values[np.newaxis], style=LineStyle(method=name))
                for name, rows in found.items()
                for count, values in zip(EXAMPLES, rows, strict=True)
            ),
        ]


def _line_name(width: str, examples: int) -> str:
    return f"{width} features, {examples:,} examples"


def rms_error(line: Line) -> float:
    """Returns the root of the mean square difference between a line and the desired function."""
    return float(np.sqrt(np.mean((line.mean - square_wave(line.x)) ** 2)))


def _text(lines: Sequence[Line]) -> str:
    errors = {line.name: f"{rms_error(line):.3f}" for line in lines}
    rows = [["RMS error by number of examples", *(f"{count:,}" for count in EXAMPLES)]]
    rows += [[f"{name} features", *(errors[_line_name(name, count)] for count in EXAMPLES)] for name in WIDTHS]
    return "\n".join(aligned(rows))


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    wave, *others = result.lines
    figure = figure_of_several(result, ax, 9, 9)
    panels: Any = figure.subplots(len(EXAMPLES), len(WIDTHS), sharex=True, sharey=True)
    for column, (name, hue) in enumerate(zip(WIDTHS, line_colors(others[:: len(EXAMPLES)], panels[0, 0]), strict=True)):
        panels[0, column].set_title(f"{name} features")
        for row, count in enumerate(EXAMPLES):
            part = panels[row, column]
            (line,) = [one for one in others if one.name == _line_name(name, count)]
            part.plot(wave.x, wave.mean, "--", color="0.5", linewidth=1)
            part.plot(line.x, line.mean, color=hue, linewidth=1.6)
            part.set_ylim(*RANGE)
            part.set_xticks([])
            part.set_yticks([])
            if column == 0:
                part.set_ylabel(f"{count:,}")
    figure.supylabel("examples")
    last: Axes = panels[-1, -1]
    return last


EXPERIMENT = CoarseCoding(
    name="figure-9.8",
    title="the width of features in coarse coding",
    book="a square wave learned from 10 to 10,240 examples, drawn at random from its extent; intervals of three widths "
    "as features, about 50 over the extent; α = 0.2 / n for n features that are present at one time",
    unspecified="the widths (0.1, 0.2 and 0.5 of the extent here), and where the wave is high (in the middle half); "
    "initial weights are zero, and the examples the same for all widths",
    names=(DESIRED, *(_line_name(name, count) for name in WIDTHS for count in EXAMPLES)),
    text=_text,
    draw=_draw,
    x_label="place in the extent",
    y_label="value",
    y_range=RANGE,
)

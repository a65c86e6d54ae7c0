"""Colors of the lines of the book's figures: one for each method, sequential ones for an ordered parameter."""

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from qtab.book.result import Line
from qtab.plots.colors import COLORS, algorithm_color, readable, sequential

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BLUE, _ORANGE, _GREEN, _PURPLE, _OCHRE, _TEAL, _RED, _GREY, _BROWN, _PINK = COLORS

METHOD_COLORS: Mapping[str, str] = {
    # chapter 2
    "ε-greedy": _BLUE,
    "greedy": _GREEN,
    "UCB": _ORANGE,
    "gradient bandit": _PURPLE,
    "optimistic greedy": _TEAL,
    # chapters 5 to 9, 12
    "TD": _BLUE,
    "Monte Carlo": _RED,
    "off-line λ-return": _GREY,
    "TD(λ)": _BLUE,
    "true online TD(λ)": _ORANGE,
    "ordinary importance sampling": _GREEN,
    "weighted importance sampling": _RED,
    # chapter 8
    "prioritized sweeping": _RED,
    "expected updates": _BLUE,
    "sample updates": _ORANGE,
    "uniform": _BLUE,
    "on-policy": _RED,
    # chapter 13
    "REINFORCE": _RED,
    "REINFORCE with baseline": _GREEN,
}
"""The color of each method that is not an algorithm of :func:`qtab.train`; those have the colors of all plots."""

_PARAMETER = re.compile(r"(.+) = (-?[\d.]+)")


def line_colors(lines: Sequence[Line], ax: "Axes") -> list[Any]:
    """Returns a color for each line.

    Three or more values of one parameter, such as ``"n = 4"``, have sequential colors in their order. Methods have a
    color each, the same in every figure. Other lines have the colors that are left.
    """
    names = [line.method or line.name for line in lines]
    parameters = [_PARAMETER.fullmatch(name) for name in names]
    if len(set(names)) > 2 and len({match and match[1] for match in parameters}) == 1 and parameters[0] is not None:
        values = [float(match[2]) for match in parameters if match is not None]
        colors = dict(zip(sorted(set(values)), sequential(sorted(set(values)), ax), strict=True))
        return [colors[value] for value in values]
    chosen = {name: METHOD_COLORS.get(name) or algorithm_color(name) for name in names}
    free = iter(hue for hue in COLORS * (len(names) // len(COLORS) + 2) if hue not in chosen.values())
    for name, hue in chosen.items():
        chosen[name] = hue or next(free)
    return [readable(str(chosen[name]), ax) for name in names]

"""Colors of the lines of the book's figures: one for each method, sequential ones for an ordered parameter."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import cycle
from typing import TYPE_CHECKING, Any

from qtab.book.line import Line
from qtab.plots.parts.colors import COLORS, algorithm_color, readable, sequential

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BLUE, _ORANGE, _GREEN, _PURPLE, _OCHRE, _TEAL, _RED, _GREY, _BROWN, _PINK = COLORS

METHOD_COLORS: Mapping[str, str] = {
    # chapter 2
    "ε-greedy": _BLUE,
    "greedy": _GREEN,
    "UCB": _ORANGE,
    "gradient bandit": _PURPLE,
    "gradient bandit without baseline": _BROWN,
    "optimistic greedy": _TEAL,
    # chapter 4
    "final values": _GREY,
    # chapters 5 to 9, 12
    "true values": _GREY,
    "TD": _BLUE,
    "Monte Carlo": _RED,
    "off-line λ-return": _GREY,
    "TD(λ)": _BLUE,
    "true online TD(λ)": _ORANGE,
    "ordinary importance sampling": _GREEN,
    "weighted importance sampling": _RED,
    # chapter 8
    "prioritized sweeping": _RED,
    "expected updates": _RED,
    "sample updates": _ORANGE,
    "uniform": _BLUE,
    "on-policy": _RED,
    # chapter 13
    "REINFORCE": _RED,
    "REINFORCE with baseline": _GREEN,
}
"""The color of each method that is not an algorithm of :func:`qtab.train`; algorithms have the colors of all plots."""

_PARAMETER = re.compile(r"(.+?)(?: =)? (-?[\d.,]+)(?:/(\d+))?([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]*)(?: episodes?)?")
"""A parameter and its value: ``"n = 4"``, ``"sweep 32"``, ``"α = 0.5/8"``, ``"α = 2⁻¹²"``, ``"after 10 episodes"``."""
_EXPONENTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def line_colors(lines: Sequence[Line], ax: "Axes") -> list[Any]:
    """Returns a color for each line.

    Three or more values of one parameter, such as ``"n = 4"``, have sequential colors in their order. Each method has
    the same color in every figure. All other lines, including unnamed ones, take the remaining colors.
    """
    names = list(dict.fromkeys(line.method or line.name for line in lines))
    chosen: dict[str, Any] = _of_parameter([line.method or line.name for line in lines if line.named], ax)
    for name in names:
        if name not in chosen and (hue := METHOD_COLORS.get(name) or algorithm_color(name)):
            chosen[name] = readable(hue, ax)
    taken = {METHOD_COLORS.get(name) or algorithm_color(name) for name in names}
    free = cycle([hue for hue in COLORS if hue not in taken] or COLORS)
    for name in names:
        if name not in chosen:
            chosen[name] = readable(next(free), ax)
    return [chosen[line.method or line.name] for line in lines]


def _of_parameter(names: Sequence[str], ax: "Axes") -> dict[str, Any]:
    """Returns a color for each value of the commonest parameter; none if it has fewer than three values."""
    found = {name: match for name in names if (match := _PARAMETER.fullmatch(name))}
    common = Counter(match[1] for match in found.values()).most_common(1)
    if not common or common[0][1] < 3:
        return {}
    values = {name: _value(match) for name, match in found.items() if match[1] == common[0][0]}
    return dict(zip(values, sequential(list(values.values()), ax), strict=True))


def _value(match: re.Match[str]) -> float:
    _, number, divisor, exponent = match.groups()
    value = float(number.replace(",", "")) / int(divisor or 1)
    return float(value ** int(exponent.translate(_EXPONENTS))) if exponent else value

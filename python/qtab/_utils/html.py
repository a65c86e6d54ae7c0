"""The HTML of a result in notebooks: a small table beside a small picture, without anything from the network.

Pictures are inline SVG: lines, bars and fields of values, in the colors of the page.
"""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

WIDTH, HEIGHT = 280, 90
"""The size of a picture in pixels."""
_LEFT, _MARGIN = 62, 6
_MAX_POINTS = 140
"""The maximum number of points of a line; longer curves are averaged."""
_MAX_CELLS = (24, 36)
"""The maximum numbers of rows and columns of a field; larger ones are averaged."""
_LEVELS = 10
"""The number of shades of a field."""
_COLORS = ("#3b82c4", "#d1662b", "#2f9f6b", "#a06ac0", "#b0892b", "#c0506a")
"""Colors that are visible on white and on black."""


def color(index: int) -> str:
    """Returns the color of a line by its index."""
    return _COLORS[index % len(_COLORS)]


def lines(title: str, curves: Mapping[str, ArrayLike], band: tuple[ArrayLike, ArrayLike] | None = None) -> str:
    """Returns a picture of lines of (points,) each, over the same range of x; empty with fewer than two points.

    Args:
        title: A description of the picture, for tooltips and screen readers.
        curves: The lines by name. Values that are not finite are left out.
        band: The lower and the upper limit of a band around the first line, (points,) each.
    """
    shown = {name: _thinned(curve) for name, curve in curves.items()}
    shown = {name: curve for name, curve in shown.items() if len(curve) > 1 and np.isfinite(curve).any()}
    if not shown:
        return ""
    limits = [] if band is None else [_thinned(limit) for limit in band]
    scale = _Scale([*shown.values(), *limits])
    parts = []
    if limits and all(np.isfinite(limit).all() for limit in limits):
        around = f"{scale.path(limits[0])}L{scale.path(limits[1], backwards=True)[1:]}z"
        parts.append(f'<path d="{around}" fill="{_COLORS[0]}" fill-opacity=".25"/>')
    for index, (name, curve) in enumerate(shown.items()):
        drawn = f'fill="none" stroke="{color(index)}" stroke-width="1.5"'
        parts.append(f'<path d="{scale.path(curve)}" {drawn}><title>{escape(name)}</title></path>')
    return _picture(title, scale.labels() + "".join(parts))


def bars(title: str, heights: ArrayLike, first: str, last: str) -> str:
    """Returns a picture of (n,) bars above zero, with labels below the first and the last."""
    tall = np.asarray(heights, dtype=np.float64)
    if not len(tall) or not np.isfinite(tall).all() or tall.max() <= 0:
        return ""
    width, bottom = (WIDTH - 2 * _MARGIN) / len(tall), HEIGHT - 18
    up = tall / tall.max() * (bottom - _MARGIN)
    drawn = "".join(
        f"M{_MARGIN + index * width:.1f} {bottom}v-{height:.1f}h{width * 0.9:.1f}V{bottom}z"
        for index, height in enumerate(up.tolist())
    )
    labels = _label(_MARGIN, HEIGHT - 4, first, "start") + _label(WIDTH - _MARGIN, HEIGHT - 4, last, "end")
    return _picture(title, f'{labels}<path d="{drawn}" fill="{_COLORS[0]}"/>')


def field(title: str, values: NDArray[np.float64]) -> str:
    """Returns a picture of (rows, columns) values, stronger if higher; empty if they are not finite."""
    if values.ndim != 2 or not values.size or not np.isfinite(values).all():
        return ""
    small = _averaged(_averaged(values, 0, _MAX_CELLS[0]), 1, _MAX_CELLS[1])
    rows, columns = small.shape
    low, high = float(small.min()), float(small.max())
    shades = np.zeros(small.shape, dtype=int)
    if high > low:
        shades = np.minimum((small - low) / (high - low) * _LEVELS, _LEVELS - 1).astype(int)
    width, height = (WIDTH - 2 * _MARGIN) / columns, (HEIGHT + 30) / rows
    paths = []
    for shade in np.unique(shades).tolist():
        cells = "".join(f"M{column} {row}h1v1h-1z" for row, column in np.argwhere(shades == shade).tolist())
        paths.append(f'<path d="{cells}" fill-opacity="{(shade + 1) / _LEVELS:.1f}"/>')
    scaled = f'<g transform="translate({_MARGIN} {_MARGIN}) scale({width:.3f} {height:.3f})" fill="{_COLORS[0]}">'
    labels = _label(_MARGIN, HEIGHT + 52, f"faintest: {_short(low)}", "start")
    labels += _label(WIDTH - _MARGIN, HEIGHT + 52, f"strongest: {_short(high)}", "end")
    return _picture(title, f"{scaled}{''.join(paths)}</g>{labels}", HEIGHT + 58)


def state_values(name: str, values: NDArray[np.float64]) -> str:
    """Returns a picture of (*cells,) values of states: a field of those with two components, else a line."""
    if values.ndim == 2:
        return field(f"{name}, {' rows by '.join(map(str, values.shape))} columns", values)
    return lines(f"{name} by the number of the state", {"value": values.ravel()})


class _Scale:
    """Maps values to the height of the picture."""

    def __init__(self, curves: Sequence[NDArray[np.float64]]) -> None:
        finite = np.concatenate([curve[np.isfinite(curve)] for curve in curves])
        self.low, self.high = float(finite.min()), float(finite.max())

    def path(self, curve: NDArray[np.float64], backwards: bool = False) -> str:
        """Returns a line through the finite values."""
        x = np.linspace(_LEFT, WIDTH - _MARGIN, len(curve))
        middle, half = (self.low / 2 + self.high / 2), (self.high / 2 - self.low / 2) or 1.0
        with np.errstate(all="ignore"):
            y = HEIGHT / 2 - (curve - middle) / half * (HEIGHT / 2 - _MARGIN)
        points = [f"{a:.0f} {b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True) if np.isfinite(b)]
        return "M" + "L".join(points[::-1] if backwards else points)

    def labels(self) -> str:
        """Returns the highest and the lowest value beside the lines."""
        if self.low == self.high:
            return _label(_LEFT - 6, HEIGHT // 2 + 4, _short(self.low), "end")
        top = _label(_LEFT - 6, 14, _short(self.high), "end")
        return top + _label(_LEFT - 6, HEIGHT - 4, _short(self.low), "end")


def _thinned(curve: ArrayLike) -> NDArray[np.float64]:
    return _averaged(np.asarray(curve, dtype=np.float64), 0, _MAX_POINTS)


def _averaged(values: NDArray[np.float64], axis: int, most: int) -> NDArray[np.float64]:
    """Averages neighbors along an axis that is longer than ``most``."""
    count = values.shape[axis]
    if count <= most:
        return values
    starts = np.linspace(0, count, most + 1).astype(int)
    shape = [1] * values.ndim
    shape[axis] = most
    with np.errstate(all="ignore"):
        means: NDArray[np.float64] = np.add.reduceat(values, starts[:-1], axis=axis) / np.diff(starts).reshape(shape)
    return means


def _picture(title: str, content: str, height: int = HEIGHT) -> str:
    label: Any = escape(title)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="{label}" viewBox="0 0 {WIDTH} {height}" '
        f'width="{WIDTH}" height="{height}"><title>{label}</title>{content}</svg>'
    )


def _label(x: float, y: float, text: str, anchor: str) -> str:
    place = f'x="{x}" y="{y}" text-anchor="{anchor}"'
    return f'<text {place} font-size="11" font-family="system-ui,sans-serif" fill="currentColor">{escape(text)}</text>'


def _short(value: float) -> str:
    return f"{value:.4g}"


MAX_TEXT = 120
"""The maximum number of characters of a text; longer ones are cut."""
_BOX = "display:flex;flex-wrap:wrap;gap:16px;align-items:center;font:13px/1.4 system-ui,sans-serif"
_TABLE = "border-collapse:collapse;margin:0;width:auto;color:inherit;font:inherit"
_DOT = "display:inline-block;width:9px;height:9px;border-radius:5px;margin-right:6px"
_CELL = "padding:1px 10px 1px 0;border:0;background:none;color:inherit"


def summary(heading: str, facts: Mapping[str, object], picture: str = "") -> str:
    """Returns a table with one fact per row, and a picture.

    Args:
        heading: A description of the result.
        facts: The names and values to show; every text is escaped.
        picture: An SVG; empty for none.
    """
    rows = "".join(
        f'<tr><th scope="row" style="{_CELL};text-align:left;font-weight:normal;opacity:.75">{_text(name)}</th>'
        f'<td style="{_CELL};text-align:left">{_text(value)}</td></tr>'
        for name, value in facts.items()
    )
    return _box(heading, rows, picture)


def listing(
    heading: str,
    columns: Sequence[str],
    rows: Sequence[Sequence[object]],
    picture: str = "",
    colors: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> str:
    """Returns a table with named columns, the first of which names the rows, and a picture.

    Args:
        heading: A description of the result.
        columns: The names of the columns.
        rows: The values of each row; every text is escaped.
        picture: An SVG; empty for none.
        colors: The colors of the first rows in the picture; empty for a row that the picture does not show.
        notes: Lines below the table and the picture.
    """
    lines = [_row("th", columns, "")]
    lines += [_row("td", row, color) for row, color in zip(rows, [*colors, *[""] * len(rows)], strict=False)]
    return _box(heading, "".join(lines), picture + _below(notes))


def sentences(heading: str, columns: Sequence[str], rows: Sequence[Sequence[object]], notes: Sequence[str] = ()) -> str:
    """Returns a table of sentences, which are wrapped but not cut.

    Args:
        heading: A description of the result.
        columns: The names of the columns; empty for a table without a header.
        rows: The values of each row; every text is escaped, and line breaks are kept. If the first column has several
            lines, the first line is the row's title.
        notes: Lines below the table.
    """
    lines = [
        "<tr>"
        + "".join(_sentences(tag, str(value).splitlines(), column == 0) for column, value in enumerate(row))
        + "</tr>"
        for tag, row in [*([("th", columns)] if columns else []), *(("td", row) for row in rows)]
    ]
    return _box(heading, "".join(lines) if rows else "", _below(notes))


def _below(notes: Sequence[str]) -> str:
    return "".join(f'<div style="flex-basis:100%">{escape(note)}</div>' for note in notes)


def _sentences(tag: str, lines: Sequence[str], is_title: bool) -> str:
    """Returns a cell, wide enough for sentences if it has several lines; the first line can be a title."""
    style = f"{_CELL};padding:4px 16px 4px 0;text-align:left;vertical-align:top;border-top:1px solid #8886"
    escaped = [escape(line) for line in lines]
    if len(lines) > 1:
        style += ";min-width:18em"
        escaped[0] = f"<b>{escaped[0]}</b>" if is_title else escaped[0]
    return f'<{tag} style="{style}">{"<br/>".join(escaped)}</{tag}>'


def _row(tag: str, values: Sequence[object], color: str) -> str:
    dot = f'<span style="{_DOT};background:{color}"></span>' if color else ""
    first, *others = values
    cells = [f'<{tag} style="{_CELL};text-align:left">{dot}{_text(first)}</{tag}>']
    cells += [f'<{tag} style="{_CELL};text-align:right">{_text(value)}</{tag}>' for value in others]
    return f"<tr>{''.join(cells)}</tr>"


def _box(heading: str, rows: str, picture: str) -> str:
    style = "caption-side:top;text-align:left;color:inherit;font-weight:bold;width:max-content;max-width:90vw"
    table = f'<caption style="{style}">{_text(heading)}</caption>{rows}'
    return f'<div style="{_BOX}"><table style="{_TABLE}">{table}</table>{picture}</div>'


def _text(value: object) -> str:
    text = str(value)
    return escape(text if len(text) <= MAX_TEXT else f"{text[: MAX_TEXT - 1]}…")

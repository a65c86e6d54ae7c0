"""The HTML of a result in notebooks: a small table beside a small picture, without anything from the network."""

from collections.abc import Mapping, Sequence
from html import escape

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

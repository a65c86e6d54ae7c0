"""What notebooks show for a result: a small table beside a small picture, without anything from the network."""

from collections.abc import Mapping, Sequence
from html import escape

MAX_TEXT = 120
"""Longer texts are cut."""
_BOX = "display:flex;flex-wrap:wrap;gap:16px;align-items:center;font:13px/1.4 system-ui,sans-serif"
_CELL = "padding:1px 10px 1px 0;border:0;background:none;color:inherit"


def summary(heading: str, facts: Mapping[str, object], picture: str = "") -> str:
    """Returns a table with one fact per row, and a picture.

    Args:
        heading: What the result is.
        facts: The names and values to show; every text is escaped.
        picture: An SVG; empty for none.
    """
    rows = "".join(
        f'<tr><th scope="row" style="{_CELL};text-align:left;font-weight:normal;opacity:.75">{_text(name)}</th>'
        f'<td style="{_CELL};text-align:left">{_text(value)}</td></tr>'
        for name, value in facts.items()
    )
    return _box(heading, rows, picture)


def listing(heading: str, columns: Sequence[str], rows: Sequence[Sequence[object]], picture: str = "") -> str:
    """Returns a table with named columns, the first of which names the rows, and a picture."""
    head = "".join(
        f'<th scope="col" style="{_CELL};text-align:{_side(index)}">{_text(name)}</th>'
        for index, name in enumerate(columns)
    )
    body = "".join(
        "<tr>"
        + "".join(f'<td style="{_CELL};text-align:{_side(i)}">{_text(value)}</td>' for i, value in enumerate(row))
        + "</tr>"
        for row in rows
    )
    return _box(heading, f"<tr>{head}</tr>{body}", picture)


def _box(heading: str, rows: str, picture: str) -> str:
    style = "caption-side:top;text-align:left;color:inherit;font-weight:bold"
    table = f'<caption style="{style}">{_text(heading)}</caption>{rows}'
    return f'<div style="{_BOX}"><table style="border-collapse:collapse;margin:0">{table}</table>{picture}</div>'


def _side(column: int) -> str:
    return "right" if column else "left"


def _text(value: object) -> str:
    text = str(value)
    return escape(text if len(text) <= MAX_TEXT else f"{text[: MAX_TEXT - 1]}…")

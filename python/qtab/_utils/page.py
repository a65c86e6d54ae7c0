"""Self-contained HTML pages: text, tables, pictures and players, without anything from the network."""

import base64
import html
from collections.abc import Sequence
from typing import Any

_STYLE = (
    ":root{color-scheme:light dark}"
    "body{font:15px/1.5 system-ui,sans-serif;max-width:64rem;margin:2rem auto;padding:0 1rem;"
    "color:#222;background:#fff}"
    "table{border-collapse:collapse}td,th{padding:.25rem .7rem;text-align:right;border-bottom:1px solid #8885}"
    "th[scope=row]{font-weight:normal;text-align:left}td{overflow-wrap:anywhere}"
    ".text td,.text th{text-align:left;vertical-align:top}"
    "figure{margin:1rem 0}img,video{max-width:100%;border-radius:4px}"
    ".wide{overflow-x:auto}code{white-space:pre-wrap}"
    "@media(prefers-color-scheme:dark){body{color:#ddd;background:#181a1b}a{color:#8ab4f8}}"
)


def page(title: str, body: str) -> str:
    """Returns a page, with light or dark colors according to the reader's system.

    Args:
        title: The title and the heading; it is escaped.
        body: HTML.
    """
    heading = html.escape(title)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{heading}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n<h1>{heading}</h1>\n{body}\n"
        "</body>\n</html>\n"
    )


def section(heading: str, body: str) -> str:
    """Returns a section; its heading is escaped."""
    return f"<h2>{html.escape(heading)}</h2>\n{body}"


def paragraph(text: str) -> str:
    """Returns a paragraph; its text is escaped."""
    return f"<p>{html.escape(text)}</p>"


def table(header: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """Returns a table of escaped values; with an empty header, the first column names the rows."""
    head = "".join(f'<th scope="col">{html.escape(name)}</th>' for name in header)
    lines = [_row(row, not header) for row in rows]
    body = "\n".join([f"<tr>{head}</tr>", *lines] if header else lines)
    return f'<div class="wide"><table{"" if header else " class=text"}>{body}</table></div>'


def picture(png: bytes, alternative: str) -> str:
    """Returns a picture with its text alternative, which is escaped."""
    uri = f"data:image/png;base64,{base64.b64encode(png).decode()}"
    return f'<img alt="{html.escape(alternative)}" src="{uri}">'


def _row(values: Sequence[Any], is_named: bool) -> str:
    cells = [f"<td>{_cell(value)}</td>" for value in values]
    if is_named and values:
        cells[0] = f'<th scope="row">{_cell(values[0])}</th>'
    return f"<tr>{''.join(cells)}</tr>"


def _cell(value: Any) -> str:
    if value is None:
        return ""
    return html.escape(f"{value:.6g}" if isinstance(value, float) else str(value))

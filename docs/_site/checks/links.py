"""Checks that the links within the built site lead to a page or file that exists, and to an anchor on the page."""

import os.path
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

if TYPE_CHECKING:
    from static import Page


def problems(site: Path, pages: Iterable["Page"]) -> Iterator[str]:
    """Yields a line for each broken link of the pages; links to other sites are not checked."""
    known = {_normal(page.path): page for page in pages}
    for page in known.values():
        for address in dict.fromkeys([*page.links, *page.loaded]):
            if problem := _problem(site, page, address, known):
                yield f"{page.path.relative_to(site)}: {address} leads to {problem}"


def _problem(site: Path, page: "Page", address: str, known: dict[Path, "Page"]) -> str | None:
    """Returns what is wrong with an address on a page; None if nothing is."""
    parts = urlsplit(address)
    if parts.scheme or parts.netloc:
        return None
    path = unquote(parts.path)
    start = site if path.startswith("/") else page.path.parent
    target = _normal(start / path.lstrip("/") if path else page.path)
    if target.is_dir():
        target /= "index.html"
    if not target.is_file():
        return "no file"
    anchor = unquote(parts.fragment)
    # A browser scrolls to the top of any page; the playground stores its settings in the anchor.
    if anchor in ("", "top") or target not in known or "=" in anchor:
        return None
    return None if anchor in known[target].anchors else f"no anchor of {target.relative_to(_normal(site))}"


def _normal(path: Path) -> Path:
    """Returns a path without `..`, as a browser resolves it."""
    return Path(os.path.normpath(path))

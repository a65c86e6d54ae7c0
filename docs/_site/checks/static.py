"""Checks the built pages without a browser: their pictures, and the addresses from which they load things."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import urlsplit

LOADED = {
    "audio": ("src",),
    "embed": ("src",),
    "iframe": ("src",),
    "img": ("src", "srcset"),
    "input": ("src",),
    "object": ("data",),
    "script": ("src",),
    "source": ("src", "srcset"),
    "track": ("src",),
    "use": ("href", "xlink:href"),
    "video": ("src", "poster"),
}
"""The attributes from which a browser loads something when it opens a page; those of `link` depend on its `rel`."""
LOADING_RELS = {"stylesheet", "icon", "preload", "prefetch", "modulepreload", "manifest", "preconnect", "dns-prefetch"}
CSS_URL = re.compile(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)")


@dataclass
class Page(HTMLParser):
    """The addresses that a page loads, its links, its anchors, and its pictures without a description."""

    path: Path
    loaded: list[str] = field(default_factory=list)
    undescribed: list[str] = field(default_factory=list)
    links: list[str] = field(default_factory=list)
    anchors: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        super().__init__()
        self._in_style = False
        self.feed(self.path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Records the addresses, the anchors and the missing description of an element."""
        given = {name: value or "" for name, value in attrs}
        self._in_style = tag == "style"
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        if tag in ("a", "area", "link") and "href" in given:
            self.links.append(given["href"])
        if tag == "link" and LOADING_RELS & set(given.get("rel", "").split()):
            self.loaded.append(given.get("href", ""))
        for name in LOADED.get(tag, ()):
            if given.get(name):
                self.loaded += (
                    [part.split()[0] for part in given[name].split(",")] if name == "srcset" else [given[name]]
                )
        self.loaded += css_urls(given.get("style", ""))
        if needs_description(tag, given) and not description(given):
            self.undescribed.append(self.get_starttag_text() or tag)

    def handle_data(self, data: str) -> None:
        """Records the addresses that a style sheet in the page loads."""
        if self._in_style:
            self.loaded += css_urls(data)


def css_urls(text: str) -> list[str]:
    """Returns the addresses in a style sheet."""
    return [first or second for first, second in CSS_URL.findall(text)]


def needs_description(tag: str, given: dict[str, str]) -> bool:
    """Whether an element is a picture that needs a description; the logo does not, as the name is next to it."""
    if given.get("aria-hidden") == "true" or "logo__image" in given.get("class", ""):
        return False
    return tag in ("img", "iframe", "video", "object") or (tag == "svg" and given.get("role") == "img")


def description(given: dict[str, str]) -> str:
    """Returns the alternative text of a picture; "" if it is only a path, which Sphinx writes if there is none."""
    words = next((given[name] for name in ("alt", "aria-label", "aria-labelledby", "title") if given.get(name)), "")
    return "" if re.fullmatch(r"\S+\.(png|jpe?g|gif|svg|webp)", words.strip()) else words.strip()


def is_foreign(address: str) -> bool:
    """Whether an address is on another server."""
    parts = urlsplit(address)
    return bool(parts.netloc) or parts.scheme not in ("", "data", "blob")


def read(site: Path) -> list[Page]:
    """Reads the pages of a built site."""
    return [Page(path) for path in sorted(site.rglob("*.html"))]


def problems(site: Path, pages: list[Page]) -> list[str]:
    """Returns a line for each picture without a description and each external address of a built site."""
    return [*_page_problems(site, pages), *_css_problems(site)]


def _page_problems(site: Path, pages: list[Page]) -> Iterator[str]:
    for page in pages:
        name = page.path.relative_to(site)
        for address in page.loaded:
            if is_foreign(address):
                yield f"{name}: loads {address}"
        for element in page.undescribed:
            yield f"{name}: no description: {element[:120]}"


def _css_problems(site: Path) -> Iterator[str]:
    for path in sorted(site.rglob("*.css")):
        for address in css_urls(path.read_text(encoding="utf-8", errors="replace")):
            if is_foreign(address):
                yield f"{path.relative_to(site)}: loads {address}"

"""The playground: a page that trains in the browser, with the core crate compiled to WebAssembly.

``qtab playground`` opens it; :func:`page` returns it as one self-contained HTML file.
"""

from qtab.playground.assemble import page, write_site
from qtab.playground.definitions import definitions

__all__ = ["definitions", "page", "write_site"]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]

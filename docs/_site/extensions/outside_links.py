"""Rewrites links that leave ``docs/``: they lead to files on GitHub, and on the site to the corresponding pages.

``[a notebook](../../examples/study.ipynb)`` becomes the page of that notebook, ``[README](../../README.md#install)``
the page with the same text, and any other file a download. So the links of a page work in both places.
A notebook that is made from a page is a download, too.
"""

import json
import os
import re
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

ROOT = Path(__file__).parents[3]
PAGES = {
    "CHANGELOG.md": "docs/reference/changelog.md",
    "CONTRIBUTING.md": "docs/reference/contributing.md",
    "SECURITY.md": "docs/reference/security.md",
    "README.md": "docs/index.md",
    "README.md#install": "docs/install.md",
}
"""The page that the site shows instead of a file outside of ``docs/``, or of a section of such a file."""

MADE_FROM_PAGES = "examples/walkthroughs/"
"""The folder of the notebooks that are made from pages: their links lead to the files."""

LINK = re.compile(r"(?<!!)(\[(?:[^\[\]]|\[[^\]]*\])*\]\()([^)\s#:]+)(#[^)\s]*)?(\))")


def on_the_site(path: str, fragment: str) -> str | None:
    """Returns the page for a path from the root of the repository; None for a file without a page.

    Raises:
        ExtensionError: if the path does not exist, or is a folder.
    """
    if path.startswith("examples/") and path.endswith(".ipynb"):
        return f"docs/notebooks/{path.removeprefix('examples/')}"
    if page := PAGES.get(path + fragment, PAGES.get(path)):
        return page
    if not (ROOT / path).is_file():
        raise ExtensionError(f"a page links to {path}, which is not a file of the repository")
    return None


def rewrite(text: str, folder: str) -> str:
    """Returns the text of a page in a folder, such as ``docs/how_to``, with the links of the site."""

    def replace(found: re.Match[str]) -> str:
        before, target, fragment, after = found.group(1), found.group(2), found.group(3) or "", found.group(4)
        path = os.path.normpath(f"{folder}/{target}").replace(os.sep, "/")
        if path.startswith("docs/"):
            return found.group()
        if path.startswith(MADE_FROM_PAGES):
            return f"{before}path:{target}{after}"  # MyST's prefix for a download
        page = on_the_site(path, fragment)
        if page is None:
            return found.group()
        page, _, anchor = page.partition("#")
        relative = os.path.relpath(page, folder).replace(os.sep, "/")
        return f"{before}{relative}{f'#{anchor}' if anchor else ''}{after}"

    return LINK.sub(replace, text)


def rewrite_page(app: Sphinx, docname: str, content: list[str]) -> None:
    """Rewrites the links of a page, or of the Markdown cells of a notebook, as it is read."""
    path = Path(app.env.doc2path(docname))
    if path.suffix == ".md":
        folder = path.parent.relative_to(ROOT).as_posix()
        content[0] = rewrite(content[0], folder)
    elif path.suffix == ".ipynb":
        notebook = json.loads(content[0])
        for cell in notebook["cells"]:
            if cell["cell_type"] == "markdown":
                folder = path.parent.relative_to(ROOT / "docs" / "notebooks").as_posix()
                cell["source"] = rewrite_notebook("".join(cell["source"]), folder)
        content[0] = json.dumps(notebook)


def rewrite_notebook(text: str, folder: str = ".") -> str:
    """Returns a cell of a notebook in a folder of ``examples/`` with links as from ``docs/notebooks``."""

    def replace(found: re.Match[str]) -> str:
        path = os.path.normpath(f"examples/{folder}/{found.group(2)}").replace(os.sep, "/")
        page = path if path.startswith("docs/") else on_the_site(path, found.group(3) or "") or path
        relative = os.path.relpath(page, f"docs/notebooks/{folder}").replace(os.sep, "/")
        return f"{found.group(1)}{relative}{found.group(3) or ''}{found.group(4)}"

    return LINK.sub(replace, text)


def setup(app: Sphinx) -> dict[str, bool]:
    """Registers the rewriting."""
    app.connect("source-read", rewrite_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

"""Makes what follows from the walk-throughs: a notebook of each page, and the pictures.

python docs/walkthroughs/make.py                      # all of it; the pictures take about a minute
python docs/walkthroughs/make.py --notebooks          # only the notebooks
python docs/walkthroughs/make.py taxi cart_pole       # only these pages

A page is the only source: its text and its blocks of Python are the cells of the notebook. The notebook prints the
numbers and draws the pictures of the page when it runs, so they are left out.
"""

import argparse
import importlib.util
import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
NOTEBOOKS = ROOT / "examples" / "walkthroughs"
DOTS_PER_INCH = 100

CODE = re.compile(
    r"^```python\n(?P<code>(?:(?!```).*\n)*?)```\n"
    r"(?:```text\n(?:(?!```).*\n)*```\n)?"
    r"(?:\n!\[[^\]]*\]\((?P<picture>[^)]+)\)\n)?",
    re.MULTILINE,
)
"""A block of Python, what it prints, and its picture."""
LINK = re.compile(r"(\]\()(?!https?:)([^)\s#]+)")
NOTEBOOK_LINE = re.compile(r"^\[This page as a notebook\].*\n\n", re.MULTILINE)


def pages() -> list[Path]:
    """Returns the walk-throughs: the pages of this folder except for their list."""
    return sorted(path for path in HERE.glob("*.md") if path.stem != "index")


def notebook(page: Path) -> str:
    """Returns a page as a notebook without outputs, in JSON."""
    cells = [
        {"cell_type": kind, "id": f"{'code' if kind == 'code' else 'text'}-{number}", "metadata": {}}
        | ({"execution_count": None, "outputs": []} if kind == "code" else {})
        | {"source": source.splitlines(keepends=True)}
        for number, (kind, source) in enumerate(_cells(page.read_text(encoding="utf-8")), 1)
    ]
    metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    stored = {"cells": cells, "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(stored, indent=1, ensure_ascii=False) + "\n"


def _cells(text: str) -> Iterator[tuple[str, str]]:
    """Yields the kind and the source of each cell of a page."""
    text = NOTEBOOK_LINE.sub("", text)
    end = 0
    for block in CODE.finditer(text):
        yield from _prose(text[end : block.start()])
        yield "code", block["code"].rstrip("\n")
        end = block.end()
    yield from _prose(text[end:])


def _prose(text: str) -> Iterator[tuple[str, str]]:
    if text.strip():
        yield "markdown", LINK.sub(lambda link: link[1] + _from_notebook(link[2]), text.strip())


def _from_notebook(target: str) -> str:
    """Returns the target of a link of a page as seen from the notebooks; other walk-throughs are notebooks, too."""
    path = HERE / target
    if path.parent == HERE and path.suffix == ".md" and path.stem != "index":
        return f"{path.stem}.ipynb"
    return Path(os.path.relpath(path, NOTEBOOKS)).as_posix()


def draw_pictures(page: Path) -> None:
    """Runs a page and writes the figure of each block that has a picture below it."""
    namespace: dict[str, Any] = {}
    for block in CODE.finditer(page.read_text(encoding="utf-8")):
        if picture := block["picture"]:
            path = HERE / picture
            _gallery().draw(block["code"], namespace, path, dots_per_inch=DOTS_PER_INCH)
            print(f"{path.name}: {path.stat().st_size / 1000:.0f} kB")
        else:
            exec(block["code"], namespace)  # noqa: S102 - the page's own code


def _gallery() -> Any:
    """Returns the script that makes the pictures of the gallery, which draws and stores those of a page."""
    spec = importlib.util.spec_from_file_location("gallery", HERE.parent / "gallery" / "pictures.py")
    if spec is None or spec.loader is None:
        raise ModuleNotFoundError("docs/gallery/pictures.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main() -> None:
    """Makes the notebooks and pictures of all pages, or of those named on the command line."""
    parser = argparse.ArgumentParser()
    parser.add_argument("pages", nargs="*", help="names without .md; default: all")
    parser.add_argument("--notebooks", action="store_true", help="without the pictures")
    asked = parser.parse_args()
    for page in pages():
        if asked.pages and page.stem not in asked.pages:
            continue
        (NOTEBOOKS / f"{page.stem}.ipynb").write_text(notebook(page), encoding="utf-8")
        if not asked.notebooks:
            draw_pictures(page)


if __name__ == "__main__":
    main()

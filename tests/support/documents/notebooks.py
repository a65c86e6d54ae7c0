"""Notebooks of examples/, stored without outputs, and what they show when they run."""

import copy
import re
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import qtab
from support.repository import ROOT

nbformat = pytest.importorskip("nbformat")

EXAMPLES = ROOT / "examples"
PNG, HTML, TEXT = "image/png", "text/html", "text/plain"


@cache
def stored(name: str) -> Any:
    """A notebook by its path in examples/ without suffix, such as ``"study"`` or ``"chapters/chapter_6"``."""
    return nbformat.read(EXAMPLES / f"{name}.ipynb", 4)


def source(name: str, cell: str) -> str:
    [text] = [one.source for one in stored(name).cells if one.id == cell]
    return str(text)


class Executed:
    """The outputs of a notebook that ran."""

    def __init__(self, cells: Sequence[Any]) -> None:
        self._cells = {cell.id: cell.outputs for cell in cells if cell.cell_type == "code"}

    def shown(self, cell: str, kind: str) -> list[str]:
        """What a cell shows of a MIME type; the text that it prints counts as plain."""
        printed = self._printed(cell) if kind == TEXT else ""
        shown = [output.data[kind] for output in self._cells[cell] if kind in output.get("data", {})]
        return [printed, *shown] if printed else shown

    def _printed(self, cell: str) -> str:
        """The text that a cell prints.

        On a busy machine it arrives in several messages, each a stream. MyST-NB appends the later ones to the first.
        """
        return next((str(output.text) for output in self._cells[cell] if "text" in output), "")

    def text(self, cell: str) -> str:
        return "\n".join(self.shown(cell, TEXT))

    @property
    def errors(self) -> list[str]:
        """What was printed on standard error, which a reader would see in red."""
        found = [output for outputs in self._cells.values() for output in outputs if _is_red(output)]
        return [output.get("text", str(output)) for output in found]


def _is_red(output: Any) -> bool:
    return bool(output.output_type == "error" or output.get("name") == "stderr")


def built_with_the_site(name: str) -> Path | None:
    """The executed notebook that a build of the site has left, if neither it nor the package has changed since."""
    built = ROOT / "docs" / "_build" / "jupyter_execute" / "notebooks" / f"{name}.ipynb"
    package = [path for path in Path(qtab.__file__).parent.rglob("*") if path.suffix in (".py", ".so", ".pyd")]
    used = [*package, EXAMPLES / f"{name}.ipynb"]
    if built.exists() and built.stat().st_mtime > max(path.stat().st_mtime for path in used):
        return built
    return None


def execute(name: str, folder: Path) -> Executed:
    """Executes a notebook in a kernel and a folder of its own."""
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    notebook = copy.deepcopy(stored(name))
    # The kernel chooses its own backend, as it does for a reader.
    with pytest.MonkeyPatch.context() as environment:
        environment.delenv("MPLBACKEND", raising=False)
        environment.setenv("IPYTHONDIR", str(folder / "ipython"))
        # A cell that fails is reported with all others of its notebook.
        client = nbclient.NotebookClient(
            notebook,
            timeout=600,
            startup_timeout=600,
            kernel_name="python3",
            allow_errors=True,
            coalesce_streams=True,
        )
        client.execute(cwd=str(folder))
    return Executed(notebook.cells)


def check_shown(
    name: str,
    folder: Path,
    *,
    pictures: str,
    tables: str,
    check: Callable[[Executed], None],
    players: str = "",
) -> None:
    """Checks what a notebook shows when it runs.

    Args:
        name: The notebook.
        folder: An empty folder to run it in, if the site was not built.
        pictures: The ids of the cells that show one picture each, separated by spaces.
        tables: The ids of the cells that show a table.
        check: Checks its numbers.
        players: The ids of the cells that show pictures in motion.
    """
    built = built_with_the_site(name)
    shown = execute(name, folder) if built is None else Executed(nbformat.read(built, 4).cells)
    assert shown.errors == []
    assert {cell: len(shown.shown(cell, PNG)) for cell in pictures.split()} == dict.fromkeys(pictures.split(), 1)
    assert [cell for cell in tables.split() if "<table" not in "".join(shown.shown(cell, HTML))] == []
    for cell in players.split():
        assert re.search(r"<(video|img)[^>]* src=|data:(video|image)/", "".join(shown.shown(cell, HTML))), cell
    check(shown)

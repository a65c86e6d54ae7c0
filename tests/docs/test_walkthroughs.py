"""The walk-throughs: each page has a notebook, which equals it, and pictures.

``test_page_code.py`` runs the pages and compares what they print. The notebooks have the same code; here one of them
runs.
"""

import importlib.util
import json
import re
from pathlib import Path
from typing import Any

import pytest

from support.repository import ROOT

FOLDER = ROOT / "docs" / "walkthroughs"
NOTEBOOKS = ROOT / "examples" / "walkthroughs"
NAMES = ["blackjack", "cart_pole", "cliff_walking", "frozen_lake", "lunar_lander", "taxi"]
SECTIONS = ["The question", "The run", "What it learned", "What goes wrong", "What to try next"]


def script() -> Any:
    spec = importlib.util.spec_from_file_location("walkthroughs", FOLDER / "make.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def code(notebook: Any) -> list[str]:
    return ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]


def test_there_are_six() -> None:
    assert [page.stem for page in script().pages()] == NAMES
    assert sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb")) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_equals_its_page(name: str) -> None:
    """If not, run ``python docs/walkthroughs/make.py --notebooks``."""
    assert (NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8") == script().notebook(FOLDER / f"{name}.md")


@pytest.mark.parametrize("name", NAMES)
def test_a_page_has_the_sections_of_a_walkthrough(name: str) -> None:
    page = (FOLDER / f"{name}.md").read_text(encoding="utf-8")
    assert re.findall(r"^## (.*)$", page, re.MULTILINE) == SECTIONS
    assert f"[This page as a notebook](../../examples/walkthroughs/{name}.ipynb)" in page


def test_every_picture_is_of_a_page_and_small() -> None:
    shown = [
        picture
        for name in NAMES
        for picture in re.findall(r"\]\((pictures/.*?)\)", (FOLDER / f"{name}.md").read_text(encoding="utf-8"))
    ]
    assert sorted(shown) == sorted(path.relative_to(FOLDER).as_posix() for path in FOLDER.glob("pictures/*"))
    assert max((FOLDER / picture).stat().st_size for picture in shown) < 60_000


@pytest.mark.parametrize("name", NAMES)
def test_the_links_of_a_notebook_lead_to_files(name: str) -> None:
    notebook = json.loads((NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8"))
    text = "\n".join("".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "markdown")
    targets = re.findall(r"\]\(([^)#\s]+)", text)
    assert len(targets) >= 2
    assert [target for target in targets if not (NOTEBOOKS / target).exists()] == []


def test_a_page_becomes_cells(tmp_path: Path) -> None:
    page = tmp_path / "two_cells.md"
    page.write_text(
        "# Two cells\n\n[This page as a notebook](../../examples/walkthroughs/two_cells.ipynb).\n\nFirst\n"
        "[this](taxi.md#the-run).\n\n```python\nprint(1)\n```\n```text\n1\n```\n\nThen [that](../book.md):\n\n"
        "```python\nax = draw()\n\n\nax.set()\n```\n\n![A picture](pictures/two.png)\n\n```text\nshown\n```\n",
        encoding="utf-8",
    )
    notebook = json.loads(script().notebook(page))
    assert ["".join(cell["source"]) for cell in notebook["cells"]] == [
        "# Two cells\n\nFirst\n[this](taxi.ipynb#the-run).",
        "print(1)",
        "Then [that](../../docs/book.md):",
        "ax = draw()\n\n\nax.set()",
        "```text\nshown\n```",
    ]
    assert [cell["cell_type"] for cell in notebook["cells"]] == ["markdown", "code", "markdown", "code", "markdown"]


@pytest.mark.docs
@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of Jupyter's libraries
def test_a_notebook_runs_and_shows_the_pictures_of_its_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    monkeypatch.delenv("MPLBACKEND", raising=False)
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    notebook = nbformat.read(NOTEBOOKS / "blackjack.ipynb", 4)
    nbclient.NotebookClient(notebook, timeout=600, startup_timeout=600, kernel_name="python3").execute(
        cwd=str(tmp_path)
    )
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert [output.text for output in outputs if output.get("name") == "stderr"] == []
    pictures = [output for output in outputs if "image/png" in output.get("data", {})]
    page = (FOLDER / "blackjack.md").read_text(encoding="utf-8")
    assert len(pictures) == page.count("](pictures/")

"""Makes pages of the notebooks in ``examples/`` and its folders: copies them to ``docs/notebooks``; myst-nb runs them.

The stored notebooks have no outputs, and no descriptions of their pictures. ``notebook_pictures.json`` has the
descriptions: for each notebook, by the id of the cell that shows the picture.

If the environment variable ``REPOSITORY`` has the address of the repository on GitHub, and ``REF`` a branch or a tag,
each page has links that open its notebook in Google Colab and Binder.
"""

import json
import os
import sys
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

ROOT = Path(__file__).parents[3]
sys.path.insert(0, str(ROOT / ".ci"))
DESCRIPTIONS = Path(__file__).with_name("notebook_pictures.json")


def copy_notebooks(app: Sphinx) -> None:
    """Writes each notebook with the descriptions of its pictures, if it changed."""
    folder = Path(app.srcdir) / "notebooks"
    descriptions = json.loads(DESCRIPTIONS.read_text(encoding="utf-8"))
    examples = ROOT / "examples"
    for path in sorted([*examples.glob("*.ipynb"), *examples.glob("[!.]*/*.ipynb")]):
        notebook = json.loads(path.read_text(encoding="utf-8"))
        described = dict(descriptions.get(path.stem, {}))
        prepare_install_cell(notebook, path.relative_to(ROOT).as_posix())
        for cell in notebook["cells"]:
            if alt := described.pop(cell["id"], None):
                cell["metadata"]["mystnb"] = {"image": {"alt": alt}}
        if described:
            raise ExtensionError(f"{path.name} has no cells {sorted(described)}, of {DESCRIPTIONS.name}")
        text = json.dumps(notebook, indent=1, ensure_ascii=False)
        target = folder / path.relative_to(examples)
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


def prepare_install_cell(notebook: dict[str, Any], path: str) -> None:
    """Puts links to Google Colab and Binder in the place of the cell that installs qtab in Colab, if there is one.

    Args:
        notebook: A notebook, which is changed.
        path: Its path in the repository.
    """
    from launch import launch

    repository, ref = os.environ.get("REPOSITORY", ""), os.environ.get("REF", "main")
    opened = launch(repository, ref, path)
    links = ", ".join(f"[open it in {name}]({address})" for name, address in opened.items())
    text = f"To run this notebook in your browser, {links}." if links else ""
    shown = [{"cell_type": "markdown", "id": "launch", "metadata": {}, "source": [text]}] if links else []
    cells = notebook["cells"]
    for index, cell in enumerate(cells):
        if cell["id"] == "install":
            cells[index : index + 1] = shown


def drop_blank_outputs(app: Sphinx, doctree: nodes.document) -> None:
    """Removes the empty output that a progress bar leaves when it is closed."""
    for output in list(doctree.findall(nodes.literal_block)):
        if not output.astext().strip():
            output.parent.remove(output)


def setup(app: Sphinx) -> dict[str, bool]:
    """Registers the copy, before Sphinx looks for pages, and the removal."""
    app.connect("builder-inited", copy_notebooks, priority=100)
    app.connect("doctree-read", drop_blank_outputs)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

"""Makes pages of the notebooks in ``examples/`` and its folders: copies them to ``docs/notebooks``; myst-nb runs them.

The stored notebooks have no outputs, and no descriptions of their pictures. ``notebook_pictures.json`` has the
descriptions: for each notebook, by the id of the cell that shows the picture.
"""

import json
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

ROOT = Path(__file__).parents[3]
DESCRIPTIONS = Path(__file__).with_name("notebook_pictures.json")


def copy_notebooks(app: Sphinx) -> None:
    """Writes each notebook with the descriptions of its pictures, if it changed."""
    folder = Path(app.srcdir) / "notebooks"
    descriptions = json.loads(DESCRIPTIONS.read_text(encoding="utf-8"))
    examples = ROOT / "examples"
    for path in sorted([*examples.glob("*.ipynb"), *examples.glob("[!.]*/*.ipynb")]):
        notebook = json.loads(path.read_text(encoding="utf-8"))
        described = dict(descriptions.get(path.stem, {}))
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

"""The playground on the site: its files in ``playground/``, and the directive ``{playground}``, a frame that shows it.

``.ci/run docs`` builds it first. Without it the site is built all the same, and the directive says what is missing.
"""

import shutil
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx
from sphinx.util import logging

SOURCE = Path(__file__).parents[2] / "python" / "qtab" / "playground"
MISSING = "This build of the site has no playground: its WebAssembly was not built."


def is_built() -> bool:
    """Whether the page is there, with its WebAssembly."""
    return (SOURCE / "index.html").is_file() and any(SOURCE.rglob("*.wasm"))


class Playground(Directive):
    """Shows the playground in a frame, or says that it is missing."""

    def run(self) -> list[nodes.Node]:
        """Returns the frame."""
        if not is_built():
            return [nodes.note("", nodes.paragraph(text=MISSING))]
        env = self.state.document.settings.env
        path = "../" * env.docname.count("/") + "playground/index.html"
        frame = f'<iframe class="playground" src="{path}" title="The playground" loading="lazy"></iframe>'
        link = f'<p><a href="{path}">Open the playground in a window of its own</a></p>'
        return [nodes.raw("", frame + link, format="html")]


def copy_playground(app: Sphinx, error: Exception | None) -> None:
    """Copies the page, its scripts and its WebAssembly."""
    if error is not None or app.builder.format != "html":
        return
    if not is_built():
        logging.getLogger(__name__).info(f"playground: {MISSING}")
        return
    target = Path(app.outdir) / "playground"
    shutil.rmtree(target, ignore_errors=True)
    shutil.copytree(SOURCE, target, ignore=shutil.ignore_patterns("*.py", "__pycache__"))


def setup(app: Sphinx) -> dict[str, bool]:
    """Registers the directive and the copy."""
    app.add_directive("playground", Playground)
    app.connect("build-finished", copy_playground)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

"""The playground on the site: its files in ``playground/``, and the directive ``{playground}``, a frame that shows it.

The role of the same name is a link to it with settings: ``{playground}`Sarsa <env=CliffWalking-v1&algorithm=sarsa>```.

``.ci/run docs`` builds its WebAssembly first. Without it, the site is still built, with a note that it is missing.
"""

from html import escape
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.docutils import ReferenceRole

from qtab.playground import assemble, write_site

MISSING = "This build of the site has no playground: its WebAssembly was not built."


def is_built() -> bool:
    """Whether the WebAssembly is there."""
    try:
        return bool(assemble.wasm())
    except FileNotFoundError:
        return False


def address(docname: str, *fragment: str) -> str:
    """The address of the playground as seen from a page, with the settings of a fragment if there is one."""
    return "../" * docname.count("/") + "playground/index.html" + "".join(f"#{part}" for part in fragment)


class PlaygroundLink(ReferenceRole):
    """A link to the playground; its text alone where the playground is missing."""

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        """Returns the link."""
        if not is_built():
            return [nodes.Text(self.title)], []
        return [nodes.reference("", self.title, refuri=address(self.env.docname, self.target), internal=True)], []


class Playground(Directive):
    """Shows the playground in a frame, or a note that it is missing. The argument is the fragment of its address."""

    optional_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Returns the frame, and the link that narrow screens show instead."""
        if not is_built():
            return [nodes.note("", nodes.paragraph(text=MISSING))]
        path = escape(address(self.state.document.settings.env.docname, *self.arguments))
        link = f'<p class="playground"><a href="{path}">Open the playground</a> in a page by itself.</p>'
        frame = f'<iframe class="playground" src="{path}" title="The playground" loading="lazy"></iframe>'
        return [nodes.raw("", link + frame, format="html")]


def copy_playground(app: Sphinx, error: Exception | None) -> None:
    """Writes the page, its scripts and its WebAssembly."""
    if error is not None or app.builder.format != "html":
        return
    if is_built():
        write_site(Path(app.outdir) / "playground")
    else:
        logging.getLogger(__name__).info(MISSING)


def setup(app: Sphinx) -> dict[str, bool]:
    """Registers the directive and the copy."""
    app.add_directive("playground", Playground)
    app.add_role("playground", PlaygroundLink())
    app.connect("build-finished", copy_playground)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

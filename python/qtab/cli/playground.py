"""``qtab playground``."""

import tempfile
import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from qtab._utils.files import replacing
from qtab._utils.progress import print_above
from qtab.cli.parsing import parse

COMMAND = "qtab playground"
FILE = "qtab-playground.html"


@dataclass(frozen=True)
class Arguments:
    """Open a page that trains agents in the browser: move a slider, and the agent learns anew."""

    out: Annotated[Path | None, tyro.conf.arg(metavar="PATH")] = None
    """Where to write the page, one HTML file that needs nothing else; by default into a temporary folder."""
    no_open: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Write the page without opening it."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    from qtab.playground import page

    html = page()
    path = options.out or Path(tempfile.mkdtemp(prefix="qtab-")) / FILE
    with replacing(path) as temporary:
        temporary.write_text(html, encoding="utf-8")
    print_above(f"Saved the playground to {path}")
    if not options.no_open and not webbrowser.open(path.absolute().as_uri()):
        print_above("No browser was found: open the file in one")
    return 0

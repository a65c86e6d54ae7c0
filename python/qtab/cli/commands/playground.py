"""Open a page that trains agents in the browser: move a slider, and the agent learns again."""

import tempfile
import webbrowser
from argparse import Namespace
from pathlib import Path

from qtab._utils.files import check_writable, replacing
from qtab._utils.progress import print_above
from qtab.cli.errors import usage_errors
from qtab.cli.parser import Parser

FILE = "qtab-playground.html"


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    out = "The file to write the page to, one self-contained HTML file; by default in a temporary folder."
    parser.option("out", Path, out, metavar="PATH")
    parser.switch("no_open", "Write the page without opening it.")


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    from qtab.playground import page

    if options.out is not None:
        with usage_errors(options):
            check_writable("out", options.out)
    html = page()
    path = options.out or Path(tempfile.mkdtemp(prefix="qtab-")) / FILE
    with replacing(path) as temporary:
        temporary.write_text(html, encoding="utf-8")
    print_above(f"Saved the playground to {path}")
    if not options.no_open and not webbrowser.open(path.absolute().as_uri()):
        print_above("No browser was found: open the file in a browser")
    return 0

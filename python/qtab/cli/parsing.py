"""tyro, with its errors in one line."""

import io
import re
from collections.abc import Sequence
from contextlib import redirect_stderr
from typing import TypeVar

import tyro

from qtab.cli.usage import UsageError

T = TypeVar("T")

_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_RULE = re.compile(r"^[─╭╰╮╯]{2,}.*$")


def parse(kind: type[T], command: str, arguments: Sequence[str], default: T | None = None) -> T:
    """Returns what the arguments make of ``kind``, a dataclass; ``--help`` prints and leaves.

    Raises:
        UsageError: for what cannot be parsed.
    """
    said = io.StringIO()
    try:
        with redirect_stderr(said):
            if default is None:
                return tyro.cli(kind, prog=command, args=arguments)
            return tyro.cli(kind, prog=command, args=arguments, default=default)
    except SystemExit as leaving:
        if leaving.code:
            raise UsageError(f"{_summary(said.getvalue())}; see {command} --help") from None
        raise


def _summary(box: str) -> str:
    """The first paragraph of an error that tyro framed, and its first suggestion."""
    paragraphs = [""]
    for line in _COLOUR.sub("", box).splitlines():
        text = line.strip().strip("│").strip()
        if _RULE.match(text):
            paragraphs.append("")
        else:
            paragraphs[-1] += f" {text}"
    told = [paragraph.strip() for paragraph in paragraphs if paragraph.strip()]
    # What each member of a union had to say is more than one line.
    summary = told[0].partition(" Got errors:")[0].rstrip(".") if told else "the arguments do not fit"
    suggestion = next((re.search(r"--[\w-]+", text) for text in told if text.startswith("Perhaps")), None)
    return f"{summary} (perhaps {suggestion[0]})" if suggestion else summary

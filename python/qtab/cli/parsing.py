"""Parsing with tyro, whose errors become one line."""

import io
import re
from collections.abc import Collection, Sequence
from contextlib import redirect_stderr
from typing import TypeVar

import tyro

from qtab.cli.usage import UsageError
from qtab.config.unknown import meant

T = TypeVar("T")

_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_RULE = re.compile(r"^[─╭╰╮╯]{2,}.*$")


def parse(kind: type[T], command: str, arguments: Sequence[str], known: Collection[str] = ()) -> T:
    """Returns the arguments as an instance of ``kind``, a dataclass. ``--help`` prints the help and exits.

    Args:
        kind: The dataclass.
        command: The command's name, for messages.
        arguments: What follows the command on the command line.
        known: The settings that are flags, to suggest one where another library's name for it is used.

    Raises:
        UsageError: for arguments that cannot be parsed.
    """
    printed = io.StringIO()
    try:
        with redirect_stderr(printed):
            return tyro.cli(kind, prog=command, args=arguments)
    except SystemExit as leaving:
        if leaving.code:
            raise UsageError(f"{_summary(printed.getvalue(), known)}; see {command} --help") from None
        raise


def _summary(box: str, known: Collection[str]) -> str:
    """The first paragraph of an error that tyro framed, and a suggestion."""
    paragraphs = [""]
    for line in _COLOUR.sub("", box).splitlines():
        text = line.strip().strip("│").strip()
        if _RULE.match(text):
            paragraphs.append("")
        else:
            paragraphs[-1] += f" {text}"
    printed = [paragraph.strip() for paragraph in paragraphs if paragraph.strip()]
    # tyro lists what each member of a union could not be parsed as, in several lines.
    summary = printed[0].partition(" Got errors:")[0].rstrip(".") if printed else "the arguments do not fit"
    summary = re.sub(r"^Error parsing (--[\w-]+): must ", r"\1 must ", summary)
    suggestion = _suggestion(printed, known)
    return f"{summary} (did you mean {suggestion}?)" if suggestion else summary


def _suggestion(printed: Sequence[str], known: Collection[str]) -> str | None:
    unrecognized = re.match(r"Unrecognized options: --([\w-]+)", printed[0]) if printed else None
    setting = unrecognized and meant(unrecognized[1].replace("-", "_"), known)
    if setting:
        return f"--{setting.replace('_', '-')}"
    suggested = next((re.search(r"--[\w-]+", text) for text in printed if text.startswith("Perhaps")), None)
    return suggested[0] if suggested else None

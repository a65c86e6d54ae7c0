"""Parsing with tyro, whose errors become one line in the words of this command."""

import dataclasses
import inspect
import io
import re
from collections.abc import Collection, Sequence
from contextlib import redirect_stderr
from types import UnionType
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin, get_type_hints

import tyro

from qtab._utils.shown import shown
from qtab._utils.suggestions import nearest
from qtab.cli.usage import UsageError, flag
from qtab.config.unknown import meant

T = TypeVar("T")

_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_RULE = re.compile(r"^(?:[─╭╰╮╯]{2,}.*|-{4,})$")
"""A line of the frame; one of hyphens where the terminal has no line-drawing characters."""


def parse(kind: type[T], command: str, arguments: Sequence[str], known: Collection[str] = ()) -> T:
    """Returns the arguments as an instance of ``kind``, a dataclass. ``--help`` prints the help and exits.

    Args:
        kind: The dataclass.
        command: The command's name, for messages.
        arguments: What follows the command on the command line.
        known: The settings that are flags besides the fields of ``kind``.

    Raises:
        UsageError: for arguments that cannot be parsed.
    """
    _use_unions_of_typing(kind)
    printed = io.StringIO()
    try:
        with redirect_stderr(printed):
            return tyro.cli(kind, prog=command, args=arguments)
    except SystemExit as leaving:
        if leaving.code:
            reason = _reason(_paragraphs(printed.getvalue()), kind, known)
            raise UsageError(f"{reason}; see {command} --help") from None
        raise


def _use_unions_of_typing(kind: type) -> None:
    """Turns ``X | None`` into ``Optional[X]``: tyro loads typeguard, for 30 ms, to check the default of the former.

    From Python 3.14 on they are the same.
    """
    for base in kind.__mro__:
        if annotations := inspect.get_annotations(base):
            base.__annotations__ = {name: _with_union_of_typing(hint) for name, hint in annotations.items()}


def _with_union_of_typing(hint: Any) -> Any:
    if get_origin(hint) is Annotated:
        inner, *rest = get_args(hint)
        return Annotated[(_with_union_of_typing(inner), *rest)]
    return Union[get_args(hint)] if isinstance(hint, UnionType) else hint  # noqa: UP007 - of any number of types


def _paragraphs(box: str) -> list[str]:
    """The paragraphs of an error that tyro framed."""
    paragraphs = [""]
    for line in _COLOUR.sub("", box).splitlines():
        text = line.strip().strip("│").strip()
        if _RULE.match(text):
            paragraphs.append("")
        else:
            paragraphs[-1] += f" {text}"
    found = [" ".join(paragraph.split()) for paragraph in paragraphs if paragraph.strip()]
    return found if "╭" in box else found[1:]  # without a frame, the title is a line of its own


def _reason(paragraphs: Sequence[str], kind: Any, known: Collection[str]) -> str:
    if not paragraphs:
        return "the arguments do not fit"
    # tyro lists what each member of a union could not be parsed as, in several lines.
    summary = paragraphs[0].partition(" Got errors:")[0].rstrip(".")
    if unrecognized := re.match(r"Unrecognized options: (.+)", summary):
        return _unknown(unrecognized[1].split(", "), kind, known)
    if missing := re.match(r"Missing value for argument .*?(--[\w-]+)", summary):
        return f"{missing[1]} needs a value"
    if missing := re.match(r"Missing from qtab \w+: (\w+) (.+?)\.? \(required\)", summary):
        return f"{missing[1]} must be given: {missing[2][0].lower()}{missing[2][1:]}"
    return re.sub(r"^Error parsing (--[\w-]+|[A-Z]+): must ", r"\1 must ", summary)


def _unknown(words: Sequence[str], kind: Any, known: Collection[str]) -> str:
    """The message for words that are no arguments: it names the first flag among them, or the first word."""
    word = next((word for word in words if word.startswith("-")), None)
    if word is None:
        return f"unexpected argument {shown(words[0])}"
    word = word.partition("=")[0]
    name = word.lstrip("-").replace("-", "_")
    flags, positional = arguments_of(kind)
    if name in positional:
        return f"unknown option {shown(word)[1:-1]} ({name} is given without a flag)"
    names = {*flags, *known}
    found = meant(name, names) or nearest(name, names)
    return f"unknown option {shown(word)[1:-1]}" + (f" (did you mean {flag(found)}?)" if found else "")


def arguments_of(kind: Any) -> tuple[set[str], set[str]]:
    """Returns the names of a dataclass's flags and of its positional arguments."""
    hints = get_type_hints(kind, include_extras=True)
    also_flags = {name.removesuffix("_flag") for name in hints if name.endswith("_flag")}
    positional = {name for name, hint in hints.items() if "Positional" in repr(hint)} - also_flags
    groups = {name for name, hint in hints.items() if dataclasses.is_dataclass(hint)}  # the settings, each by its name
    flags = {field.name.removesuffix("_flag") for field in dataclasses.fields(kind)} - positional - groups
    return flags, positional

"""The pages of the documentation, and the Python in them."""

import contextlib
import io
import linecache
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

from support.repository import ROOT, tracked_files

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """A fenced block of Python, and the text block directly below it: what it prints, with `...` for anything."""

    code: str
    printed: str | None


def pages() -> list[Path]:
    """The Markdown pages at the top of the repository and of the documentation."""
    return [path for path in tracked_files(".md") if path.parent == ROOT or path.is_relative_to(ROOT / "docs")]


def page_id(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def blocks(text: str, language: str = "python") -> Iterator[Block]:
    """The blocks of a language in a page, in order."""
    found = list(FENCE.finditer(text))
    for block, following in zip_longest(found, found[1:]):
        if block[1] == language:
            is_output = following is not None and following[1] == "text" and following.start() == block.end() + 1
            yield Block(block[2], following[2] if is_output and following is not None else None)


def run(page: Path, *, fewer: dict[str, str] | None = None) -> dict[str, Any]:
    """Runs the Python of a page in order, in one namespace, as a reader would paste it, and compares what it prints.

    Args:
        page: The page.
        fewer: Patterns to replace in the code, such as numbers of seeds.

    Returns:
        The namespace after the last block.
    """
    namespace: dict[str, Any] = {"__name__": "page"}
    for number, block in enumerate(blocks(page.read_text(encoding="utf-8")), 1):
        code = block.code
        for pattern, replacement in (fewer or {}).items():
            code = re.sub(pattern, replacement, code)
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            name = f"<{page_id(page)}, block {number}>"
            linecache.cache[name] = (len(code), None, code.splitlines(keepends=True), name)  # as IPython does for cells
            exec(compile(code, name, "exec"), namespace)  # noqa: S102 - our own page
        if block.printed is not None:
            assert matches(block.printed, printed.getvalue()), f"{code}\nprints\n{printed.getvalue()}"
    return namespace


def matches(expected: str, printed: str) -> bool:
    """Whether a text is the expected one, in which `...` stands for any text."""
    pattern = ".*".join(re.escape(part.strip("\n")) for part in expected.rstrip().split("..."))
    return re.fullmatch(rf"\n*{pattern}\s*", _stripped(printed), re.DOTALL) is not None


def _stripped(text: str) -> str:
    return "\n".join(line.rstrip() for line in text.splitlines())

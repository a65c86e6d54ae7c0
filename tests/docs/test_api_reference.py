"""The reference of the documentation: it has every public name, and no other."""

import re
from typing import Any

import pytest

import qtab
from support.repository import ROOT

package: Any = qtab  # its `__all__` is hidden from type checkers
PUBLIC: list[str] = package.__all__
PAGES = sorted((ROOT / "docs/reference/api").glob("*.md"))
MODULES = ("book", "callbacks", "designs", "exercises", "planning", "playground", "plots", "prediction", "sb3", "stats")
LISTED = re.compile(r"^(?:   |\.\. py:data:: )(qtab\.[\w.]+)$", re.MULTILINE)


def listed() -> list[str]:
    return [name for page in PAGES for name in LISTED.findall(page.read_text(encoding="utf-8"))]


def public() -> set[str]:
    """The public names; of a module its own instead, without those that are also at the top."""
    top = set(PUBLIC) - set(MODULES)
    inner = {f"{module}.{name}" for module in MODULES for name in set(getattr(qtab, module).__all__) - top}
    return {f"qtab.{name}" for name in top | inner}


def test_the_reference_lists_every_public_name_once() -> None:
    names = listed()
    assert set(names) == public()
    assert len(names) == len(set(names))


def test_every_module_among_the_public_names_is_known_here() -> None:
    modules = {name for name in PUBLIC if type(getattr(qtab, name)).__name__ == "module"}
    assert modules == set(MODULES)


@pytest.mark.parametrize("name", sorted(name for name in public() if not name.startswith("qtab.sb3")))
def test_a_public_name_is_explained(name: str) -> None:
    value: object = qtab
    for part in name.split(".")[1:]:
        value = getattr(value, part)
    assert (value.__doc__ or "").strip()

"""The links of the documentation into the playground hold settings that the page accepts."""

import re

import pytest

from support.documents import pages
from support.playground import Playground
from support.repository import ROOT

ROLE = re.compile(r"\{playground\}`[^`<]*<([^`>]*)>`|```\{playground\} (\S+)|`(env=[^`\s]*)`")
FRAGMENTS = sorted(
    {
        next(filter(None, found.groups()))
        for page in pages.pages()
        if page.is_relative_to(ROOT / "docs")
        for found in ROLE.finditer(page.read_text(encoding="utf-8"))
        if any(found.groups()) and found.group() != "`env=`"
    }
)


@pytest.mark.browser
@pytest.mark.parametrize("fragment", FRAGMENTS)
def test_a_link_opens_what_it_names(playground: Playground, fragment: str) -> None:
    playground.open(f"#{fragment}")
    assert not playground.page.locator("#problem").is_visible()
    parts = dict(part.split("=") for part in fragment.split("&"))
    state = playground.state()
    assert state["environment"] == parts["env"]
    for name in parts.keys() & state["settings"].keys():
        assert str(state["settings"][name]) == parts[name]


def test_the_pages_have_links() -> None:
    assert len(FRAGMENTS) > 10

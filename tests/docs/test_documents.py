"""The pages of the repository: their links and paths exist, their pictures are described."""

import functools
import re
from pathlib import Path

import pytest

from support.documents.pages import FENCE, page_id, pages
from support.repository import ROOT

PAGES = pages()
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")


def anchor(heading: str) -> str:
    """The fragment that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


@functools.cache
def anchors(page: Path) -> set[str]:
    return {anchor(heading) for heading in re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)}


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_links_lead_to_files_and_headings_that_exist(page: Path) -> None:
    for _, _, target in LINK.findall(page.read_text(encoding="utf-8")):
        if target.startswith(("https://", "http://")):
            continue
        path, _, fragment = target.partition("#")
        linked = page.parent / path if path else page
        assert linked.exists(), target
        assert not fragment or linked.suffix != ".md" or fragment in anchors(linked), target


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_every_picture_has_an_alternative_text(page: Path) -> None:
    for picture, text, target in LINK.findall(page.read_text(encoding="utf-8")):
        assert not picture or len(text) > 40, target


LONGEST_LINE = 110
"""The box of a block of code on the site has room for so many letters in a window of 1,400 pixels."""
WRAPPED = ("", "text", "none")
"""The languages of blocks whose long lines the style sheet breaks."""


@pytest.mark.parametrize("page", [page for page in PAGES if page.is_relative_to(ROOT / "docs")], ids=page_id)
def test_lines_of_code_fit_into_their_box_on_the_site(page: Path) -> None:
    blocks = FENCE.findall(page.read_text(encoding="utf-8"))
    lines = [line for language, code in blocks if language not in WRAPPED for line in code.splitlines()]
    assert [line for line in lines if len(line) > LONGEST_LINE] == []


def test_the_paths_that_contributing_names_exist() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    layout = re.search(r"## Where things are\n\n```\n(.*?)```", text, re.DOTALL)
    assert layout is not None
    folder = ROOT
    paths = []
    for line in layout.group(1).splitlines():
        names = re.match(r"( *)(\S+(?: \S+)*)", line)
        assert names is not None, line
        if not names.group(1):
            folder = ROOT / names.group(2).split()[0]
            paths += [ROOT / name for name in names.group(2).split()]
        else:
            paths += [folder / name for name in names.group(2).split()]
    paths += [ROOT / name for name in re.findall(r"`((?:rust|python|tests|docs)/[\w./-]+)`", text)]
    assert len(paths) > 30
    assert [path for path in paths if not path.exists()] == []


def test_the_readme_has_its_two_commands() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for marker, end in (("train", "qtab train --plot rewards.png --save run.npz"), ("test", "-m pytest")):
        assert re.search(rf"<!-- {marker} -->\n```sh\npython3 -m venv \.venv && .*{re.escape(end)}\n```", text), marker

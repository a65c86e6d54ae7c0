"""The checks of the built site find what they are for."""

import importlib.util
from pathlib import Path
from typing import Any

import pytest

from support.repository import ROOT


def load(path: str) -> Any:
    spec = importlib.util.spec_from_file_location(Path(path).stem, ROOT / path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def problems(site: Path) -> list[str]:
    static = load("docs/_site/checks/static.py")
    found: list[str] = static.problems(site, static.read(site))
    return found


def broken_links(site: Path) -> list[str]:
    pages = load("docs/_site/checks/static.py").read(site)
    return list(load("docs/_site/checks/links.py").problems(site, pages))


@pytest.mark.parametrize(
    ("html", "problem"),
    [
        ('<img src="a.png">', "no description"),
        ('<img src="a.png" alt="">', "no description"),
        ('<img src="a.png" alt="../_images/a.png">', "no description"),  # what Sphinx writes without one
        ('<svg role="img"></svg>', "no description"),
        ('<iframe src="playground/index.html"></iframe>', "no description"),
        ('<script src="https://cdn.example/x.js"></script>', "loads https://cdn.example/x.js"),
        ('<link rel="stylesheet" href="//fonts.example/a.css">', "loads //fonts.example/a.css"),
        ('<img alt="A curve" srcset="a.png 1x, https://example.com/b.png 2x">', "loads https://example.com/b.png"),
        ("<style>@import 'https://example.com/a.css';</style>", "loads https://example.com/a.css"),
        ('<p style="background: url(http://example.com/a.png)">', "loads http://example.com/a.png"),
    ],
)
def test_a_bad_page_is_found(tmp_path: Path, html: str, problem: str) -> None:
    (tmp_path / "page.html").write_text(html, encoding="utf-8")
    (found,) = problems(tmp_path)
    assert found.startswith(f"page.html: {problem}")


def test_a_bad_style_sheet_is_found(tmp_path: Path) -> None:
    (tmp_path / "site.css").write_text("a { background: url(https://example.com/a.png) }", encoding="utf-8")
    assert problems(tmp_path) == ["site.css: loads https://example.com/a.png"]


def test_a_good_page_is_left_in_peace(tmp_path: Path) -> None:
    page = """<link rel="canonical" href="https://example.com"><a href="https://example.com">elsewhere</a>
    <img class="logo__image" src="icon.svg" alt=""><svg aria-hidden="true" role="img"></svg>
    <img src="data:image/png;base64,AAAA" alt="A learning curve"><script src="_static/a.js"></script>"""
    (tmp_path / "page.html").write_text(page, encoding="utf-8")
    assert problems(tmp_path) == []


@pytest.mark.parametrize(
    ("address", "problem"),
    [
        ("other.html", "no file"),
        ("../guide/nothing.html#a", "no file"),
        ("../../../etc", "no file"),
        ("page.html#c", "no anchor of guide/page.html"),
        ("#c", "no anchor of guide/page.html"),
        ("/#a", "no anchor of index.html"),
        ("../#b", "no anchor of index.html"),
    ],
)
def test_a_broken_link_is_found(tmp_path: Path, address: str, problem: str) -> None:
    folder = tmp_path / "site" / "guide"
    folder.mkdir(parents=True)
    (folder.parent / "index.html").write_text("<h1 id='top-of-all'>", encoding="utf-8")
    (folder / "page.html").write_text(f'<h1 id="a"><a href="{address}">x</a>', encoding="utf-8")
    assert broken_links(folder.parent) == [f"guide/page.html: {address} leads to {problem}"]


def test_links_that_lead_somewhere_are_left_in_peace(tmp_path: Path) -> None:
    (tmp_path / "play ground").mkdir()
    (tmp_path / "play ground" / "index.html").write_text("<a name='b'></a>", encoding="utf-8")
    addresses = [
        "",
        "#a",
        "#",
        "page.html?v=1#a",
        "play%20ground/#b",
        "play%20ground/index.html#env=grid",
        "/page.html",
    ]
    addresses += ["mailto:someone@example.com", "https://example.com/x#y", "#%C3%A9", "#top"]
    html = "".join(f'<a href="{address}">x</a>' for address in addresses)
    (tmp_path / "page.html").write_text(f'<h1 id="a"><p id="é">{html}', encoding="utf-8")
    assert broken_links(tmp_path) == []


def test_a_page_of_a_notebook_has_links_in_the_place_of_the_cell_that_installs(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("sphinx")
    extension = load("docs/_site/extensions/notebooks.py")
    texts = {}
    for repository in ("", "https://example.org/someone/qtab", "https://github.com/someone/qtab"):
        monkeypatch.setenv("REPOSITORY", repository)
        notebook = {"cells": [{"id": "title"}, {"id": "install"}, {"id": "train"}]}
        extension.prepare_install_cell(notebook, "examples/chapters/chapter_2.ipynb")
        texts[repository] = [cell.get("source", [""])[0] for cell in notebook["cells"]]
    title, links, code = texts.pop("https://github.com/someone/qtab")
    colab = "https://colab.research.google.com/github/someone/qtab/blob/main/examples/chapters/chapter_2.ipynb"
    binder = "https://mybinder.org/v2/gh/someone/qtab/main?labpath=examples%2Fchapters%2Fchapter_2.ipynb"
    assert f"[open it in Colab]({colab}), [open it in Binder]({binder})" in links
    assert list(texts.values()) == [[title, code]] * 2


def test_links_out_of_the_documentation_become_pages_of_the_site() -> None:
    pytest.importorskip("sphinx")
    links = load("docs/_site/extensions/outside_links.py")
    text = "[a](../../examples/study.ipynb) [b](../../CONTRIBUTING.md#tasks) [c](spaces.md) ![d](../gallery/x.png)"
    assert links.rewrite(text, "docs/how_to") == (
        "[a](../notebooks/study.ipynb) [b](../reference/contributing.md) [c](spaces.md) ![d](../gallery/x.png)"
    )
    made = "[a notebook](../../examples/walkthroughs/taxi.ipynb)"
    assert links.rewrite(made, "docs/walkthroughs") == made.replace("](", "](path:")
    assert (
        links.rewrite_notebook("[e](chapters/chapter_6.ipynb) [f](../docs/book.md#x)")
        == "[e](chapters/chapter_6.ipynb) [f](../book.md#x)"
    )
    assert (
        links.rewrite_notebook("[e](../study.ipynb) [f](../../docs/book.md#x)", "chapters")
        == "[e](../study.ipynb) [f](../../book.md#x)"
    )
    with pytest.raises(Exception, match="not a file of the repository"):
        links.rewrite("[g](../../nothing.md)", "docs/how_to")


def test_the_search_finds_names_in_both_spellings() -> None:
    pytest.importorskip("sphinx")
    split = load("docs/_site/extensions/search_words.py").BothSpellings({}).split
    assert split("FrozenLake-v1") == ["FrozenLake", "v1", "Frozen", "Lake", "v", "1"]
    assert split("a frozen lake") == ["a", "frozen", "lake", "frozenlake"]
    assert split("Stable-Baselines3") == ["Stable", "Baselines3", "Baselines", "3"]
    assert split("train_many") == ["train_many", "train", "many"]
    assert split("large lakes") == ["large", "lakes"]


def test_thirty_queries_are_tried_in_the_search() -> None:
    expected = load("docs/_site/checks/search.py").EXPECTED
    assert len(expected) >= 30
    assert {"frozen lake", "lunar lander", "colab", "gpu", "stable baselines"} <= set(expected)
    pages = {page.partition("#")[0] for page in expected.values() if "generated" not in page}
    assert [page for page in pages if not (ROOT / "docs" / f"{page}.md").exists()] == []

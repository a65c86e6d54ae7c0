"""The pages of the exercises have the starter code, and solutions that pass, in at most twenty lines."""

import ast
import io
import re
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import pytest

from qtab.exercises import EXERCISES, Report, check
from support.documents import pages
from support.repository import ROOT

PAGES = [path for path in pages.pages() if path.parent == ROOT / "docs/exercises"]
MAX_LINES = 20


def page_of(name: str) -> Path:
    exercise = EXERCISES[name]
    (page,) = [page for page in PAGES if f"\n## {exercise.number}. {exercise.title}\n" in page.read_text("utf-8")]
    return page


def function_of(code: str, name: str) -> ast.FunctionDef | None:
    found = [node for node in ast.parse(code).body if isinstance(node, ast.FunctionDef) and node.name == name]
    return found[0] if found else None


@pytest.mark.parametrize("name", EXERCISES)
def test_a_page_has_the_starter_code_of_each_exercise(name: str) -> None:
    starters = [block.code for block in pages.blocks(page_of(name).read_text("utf-8"), "py")]
    assert EXERCISES[name].starter in starters
    assert f"*Sutton & Barto, section {EXERCISES[name].section}.*" in page_of(name).read_text("utf-8")


@pytest.mark.parametrize("page", PAGES, ids=pages.page_id)
def test_the_solutions_pass_in_twenty_lines(page: Path) -> None:
    namespace: dict[str, Any] = {}
    for block in pages.blocks(page.read_text("utf-8")):
        with redirect_stdout(io.StringIO()):
            exec(block.code, namespace)  # noqa: S102 - our own page
        for name in EXERCISES:
            function = function_of(block.code, name)
            if function is None or page != page_of(name):
                continue
            lines = [line for line in (ast.get_source_segment(block.code, function) or "").splitlines() if line.strip()]
            assert len(lines) <= MAX_LINES + 1, name  # the first line is that of the starter code
            report = check(name, namespace[name])
            assert isinstance(report, Report)
            report.assert_passed()


def test_every_exercise_has_a_solution() -> None:
    codes = [block.code for page in PAGES for block in pages.blocks(page.read_text("utf-8"))]
    for name in EXERCISES:
        assert any(function_of(code, name) and f'check("{name}", {name})' in code for code in codes), name


def test_the_overview_links_to_every_exercise() -> None:
    text = (ROOT / "docs/exercises/index.md").read_text("utf-8")
    rows = re.findall(r"^\| (\d+) \| \[(.+)\]\((\w+\.md)#", text, re.MULTILINE)
    expected = [(str(one.number), one.title, page_of(one.name).name) for one in EXERCISES.values()]
    assert rows == expected

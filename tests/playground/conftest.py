"""A browser for the tests of the playground, and the page as one file."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import qtab.playground
from support.playground import PATIENCE, Playground

CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """Chromium, as Debian installs it; the environment variable CHROMIUM names another."""
    api = pytest.importorskip("playwright.sync_api")
    if not Path(CHROMIUM).exists():
        pytest.skip(f"needs Chromium: {CHROMIUM} does not exist")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"], timeout=PATIENCE)
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The playground as one file."""
    file = tmp_path_factory.mktemp("playground") / "playground.html"
    file.write_text(qtab.playground.page(), encoding="utf-8")
    return file


@pytest.fixture
def context(chromium: Any) -> Iterator[Any]:
    """A window of 1280 x 900 pixels."""
    context = chromium.new_context(viewport={"width": 1280, "height": 900}, reduced_motion="reduce")
    yield context
    context.close()


@pytest.fixture
def playground(context: Any, page_file: Path) -> Iterator[Playground]:
    """The page, whose console must stay empty and which must not ask for anything."""
    opened = Playground(context, page_file)
    yield opened
    assert opened.problems == []
    asked = {url for url in opened.requests if url.split(":")[0] not in ("data", "blob", "about")}
    assert {url.split("#")[0].split("?")[0] for url in asked} <= {page_file.as_uri()}

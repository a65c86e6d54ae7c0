"""What the page says of each example holds, over the seeds that it offers: 0 to 15."""

from pathlib import Path
from typing import Any

import pytest

from support.playground import Playground
from support.playground.lessons import Claims, Lesson, Lessons, control, games, grids, lakes

pytestmark = [pytest.mark.browser, pytest.mark.slow]

STATES = """() => {
  const { store, EXAMPLES, exampleState } = globalThis.playground;
  return Object.entries(EXAMPLES).flatMap(([environment, examples]) =>
    examples.map((example, index) => ({ ...example, ...exampleState(store, environment, index) })));
}"""
CLAIMS: Claims = {**control.CLAIMS, **lakes.CLAIMS, **grids.CLAIMS, **games.CLAIMS}


@pytest.fixture(scope="module")
def lessons(chromium: Any, page_file: Path) -> Lessons:
    context = chromium.new_context()
    page = Playground(context, page_file).open().page
    states = page.evaluate(STATES)
    context.close()
    return {
        (state["environment"], state["title"]): Lesson(state["environment"], state["settings"], state["grid"])
        for state in states
    }


def test_every_example_has_a_claim(lessons: Lessons) -> None:
    assert lessons.keys() == CLAIMS.keys()


@pytest.mark.parametrize("example", CLAIMS, ids=": ".join)
def test_what_an_example_says_holds(lessons: Lessons, example: tuple[str, str]) -> None:
    CLAIMS[example](lessons[example], lessons)

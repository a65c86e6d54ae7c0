"""The grid world that one paints: the agent reroutes at once."""

import pytest

from support.playground import Playground

pytestmark = pytest.mark.browser

PLACE = """cell => {
  const { view } = playground;
  const { x, y, width, height } = view.values.frame.cell(cell);
  const box = view.values.canvas.getBoundingClientRect();
  return [box.left + x + width / 2, box.top + y + height / 2];
}"""


@pytest.fixture
def painting(playground: Playground) -> Playground:
    playground.open("#env=grid&example=0")
    playground.page.locator("#values").scroll_into_view_if_needed()
    return playground


def layout(playground: Playground) -> list[str]:
    found: list[str] = playground.state()["grid"]["layout"]
    return found


def choose(playground: Playground, tool: str) -> None:
    playground.page.locator(f'[data-tool="{tool}"]').click()


def press(playground: Playground, cell: int) -> None:
    playground.page.mouse.click(*playground.page.evaluate(PLACE, cell))
    playground.settled()


def test_a_wall_changes_the_path(painting: Playground) -> None:
    path = "() => Array.from(playground.view.episode.cells)"
    assert painting.page.evaluate(path) == [17, 18, 19, 20, 21, 22]
    choose(painting, "#")
    x, y = painting.page.evaluate(PLACE, 12)
    painting.page.mouse.move(x, y)
    painting.page.mouse.down()
    for cell in (20, 28, 36):
        painting.page.mouse.move(*painting.page.evaluate(PLACE, cell), steps=2)
    painting.page.mouse.up()
    painting.settled()
    assert [row[4] for row in layout(painting)] == [".", "#", "#", "#", "#", "."]
    around = painting.page.evaluate(path)
    assert len(around) == 10 or len(around) == 12
    assert not {12, 20, 28, 36} & set(around)
    assert painting.result()["values"][20] is None


def test_every_tool_paints_what_it_names(painting: Playground) -> None:
    choose(painting, "#")
    press(painting, 0)
    assert layout(painting)[0][0] == "#"
    press(painting, 0)
    assert layout(painting)[0][0] == ".", "a second press takes a wall away"
    choose(painting, "G")
    press(painting, 7)
    assert layout(painting)[0][7] == "G"
    choose(painting, ".")
    press(painting, 7)
    assert layout(painting)[0][7] == "."
    choose(painting, "S")
    press(painting, 40)
    assert [row.count("S") for row in layout(painting)] == [0, 0, 0, 0, 0, 1]
    choose(painting, "reward")
    press(painting, 9)
    assert painting.state()["grid"]["rewards"] == [[1, 1, -10]]


def test_the_keyboard_paints(painting: Playground) -> None:
    painting.page.locator('[data-tool="select"]').focus()
    painting.page.keyboard.press("ArrowRight")
    painting.page.locator(".map-cell").focus()
    for key in ("Home", "ArrowRight", "ArrowDown", "Enter"):
        painting.page.keyboard.press(key)
    painting.settled()
    assert sum(row.count("#") for row in layout(painting)) == 1
    painting.page.wait_for_function("() => document.querySelector('#live').textContent.includes('wall')")


def test_the_last_start_stays(painting: Playground) -> None:
    choose(painting, "#")
    painting.page.mouse.click(*painting.page.evaluate(PLACE, 17))
    assert layout(painting)[2][1] == "S"
    painting.page.wait_for_function("() => document.querySelector('#live').textContent.includes('needs a start')")


def test_the_size_and_the_rewards_change(painting: Playground) -> None:
    for field, text in ("rows", "4"), ("columns", "5"), ("step_reward", "-2"), ("goal_reward", "7"):
        painting.page.locator(f"#paint-{field}").fill(text)
        painting.page.locator(f"#paint-{field}").press("Enter")
        painting.settled()
    grid = painting.state()["grid"]
    assert [len(grid["layout"]), len(grid["layout"][0]), len(grid["wind"])] == [4, 5, 5]
    assert (grid["step_reward"], grid["goal_reward"]) == (-2, 7)
    assert painting.result()["columns"] == 5
    painting.page.locator("#paint-rows").fill("1e9")
    painting.page.locator("#paint-rows").press("Enter")
    assert "rows must be in [1, 20]" in painting.text("painter")
    painting.page.locator("#paint-begin").select_option("Dyna maze")
    painting.settled()
    assert painting.result()["columns"] == 9

"""The page without a pointer: order of focus, arrow keys, shortcuts, and what screen readers are told."""

import pytest

from support.playground import Playground

pytestmark = pytest.mark.browser

FOCUSED = """() => {
  const element = document.activeElement;
  const style = getComputedStyle(element);
  return {
    id: element.id || element.dataset.tool || element.className || element.tagName,
    name: element.getAttribute("aria-label") || element.labels?.[0]?.innerText || element.innerText || element.title,
    outline: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2,
  };
}"""


def press(playground: Playground, *keys: str) -> None:
    for key in keys:
        playground.page.keyboard.press(key)


def test_everything_that_can_be_pressed_is_reached_with_tab_and_seen(playground: Playground) -> None:
    playground.open("#env=grid&episodes=20")
    playground.page.locator("details.more > summary").click()
    playground.page.evaluate("() => { document.activeElement.blur(); scrollTo(0, 0); }")
    wanted = playground.page.evaluate(
        """() => [...document.querySelectorAll("button, select, input, summary, .map-cell")].filter((element) =>
          element.checkVisibility() && !element.disabled && element.tabIndex >= 0).length"""
    )
    reached = set()
    for _ in range(wanted + 4):
        press(playground, "Tab")
        found = playground.page.evaluate(FOCUSED)
        if found["id"] in ("BODY", "skip"):
            continue
        assert found["outline"], found
        assert found["name"], found
        reached.add(
            playground.page.evaluate("() => [...document.querySelectorAll('*')].indexOf(document.activeElement)")
        )
    assert len(reached) >= wanted


def test_the_link_to_the_results_keeps_the_settings(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20")
    state = playground.state()
    playground.page.locator(".skip").focus()
    press(playground, "Enter")
    assert playground.page.evaluate("() => document.activeElement.id") == "results"
    assert playground.state() == state
    assert "episodes=20" in playground.page.url


def test_a_state_is_selected_with_the_arrow_keys(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1")
    press(playground, "v", "Home", "ArrowUp", "ArrowUp", "ArrowRight")
    label = playground.page.evaluate("() => document.activeElement.getAttribute('aria-label')")
    assert label.startswith("Row ")
    before = playground.page.evaluate(
        "() => [playground.view.values.focused, document.querySelectorAll('.map-cell').length]"
    )
    assert before[1] == 1, "only one cell takes the focus with Tab"
    press(playground, "Enter")
    playground.page.wait_for_function("cell => playground.view.result.inspection?.cell === cell", arg=before[0])
    assert playground.text("inspector-title").startswith("State ")
    playground.page.wait_for_function("() => document.querySelector('#live').textContent.includes('Selected')")


def test_an_environment_is_chosen_with_the_arrow_keys(playground: Playground) -> None:
    playground.open("#env=MountainCar-v0&episodes=20")
    playground.page.locator('#environments [aria-checked="true"]').focus()
    press(playground, "ArrowRight")
    playground.settled()
    assert playground.state()["environment"] == "CartPole-v1"
    assert playground.page.evaluate("() => document.activeElement.getAttribute('aria-checked')") == "true"


def test_shortcuts_train_and_can_be_turned_off(playground: Playground) -> None:
    playground.open("#env=grid&example=0")
    press(playground, "0")
    playground.settled()
    press(playground, "s")
    playground.settled()
    assert sum(playground.result()["visits"]) == 1
    press(playground, "e")
    playground.settled()
    assert playground.result()["done"] == 1
    press(playground, "r")
    playground.page.wait_for_function("() => playground.training.state === 'finished'")
    press(playground, "?")
    assert playground.page.locator("#shortcuts-dialog").is_visible()
    assert playground.page.locator("#shortcuts-table tr").count() >= 9
    playground.page.locator("#shortcuts-on").focus()
    press(playground, "Space", "Escape")
    assert not playground.page.locator("#shortcuts-dialog").is_visible()
    playground.settled()
    trained = playground.page.evaluate("() => playground.training.id")
    press(playground, "0")
    assert playground.page.evaluate("() => playground.training.id") == trained


def test_letters_that_are_typed_are_not_shortcuts(playground: Playground) -> None:
    playground.open("#env=grid&episodes=20")
    trained = playground.page.evaluate("() => playground.training.id")
    playground.page.locator("#set-seed").focus()
    press(playground, "0", "e", "s")
    assert playground.page.evaluate("() => playground.training.id") == trained


def test_results_are_announced(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1")
    playground.page.wait_for_function("() => document.querySelector('#live').textContent.includes('Finished')")
    assert "Mean return" in playground.page.locator("#live").text_content()


def test_motion_waits_where_less_of_it_is_wanted(playground: Playground) -> None:
    playground.open("#env=MountainCar-v0&episodes=20")
    assert not playground.page.evaluate("() => playground.view.motion.playing")
    playground.page.locator("#motion-step").focus()
    press(playground, "ArrowRight", "ArrowRight")
    assert playground.page.evaluate("() => Math.floor(playground.view.motion.time)") == 2

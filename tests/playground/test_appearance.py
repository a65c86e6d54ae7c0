"""Small screens, light and dark colors, and the numbers of a contrast that is high enough."""

from pathlib import Path
from typing import Any

import pytest

from qtab.playground import definitions
from support.playground import Playground

pytestmark = pytest.mark.browser

CONTRASTS = """() => {
  const channels = (color) => {
    const canvas = new OffscreenCanvas(1, 1).getContext("2d");
    canvas.fillStyle = color;
    canvas.fillRect(0, 0, 1, 1);
    return [...canvas.getImageData(0, 0, 1, 1).data];
  };
  const light = ([red, green, blue]) => {
    const [r, g, b] = [red, green, blue].map((part) => part / 255).map((part) =>
      part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const color = getComputedStyle(at).backgroundColor;
      if (channels(color)[3] === 255) return channels(color);
    }
    return [255, 255, 255];
  };
  const low = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement;
    const isShown = walker.currentNode.textContent.trim() && element.checkVisibility();
    if (!isShown || element.closest("script, style, .hidden-text, :disabled")) continue;
    const [one, other] = [light(channels(getComputedStyle(element).color)), light(behind(element))];
    const contrast = (Math.max(one, other) + 0.05) / (Math.min(one, other) + 0.05);
    if (contrast < 4.5) low.push([walker.currentNode.textContent.trim(), contrast]);
  }
  return low;
}"""


@pytest.fixture
def window(chromium: Any, page_file: Path, request: pytest.FixtureRequest) -> Any:
    context = chromium.new_context(**request.param)
    yield Playground(context, page_file)
    context.close()


@pytest.mark.parametrize("window", [{"viewport": {"width": 360, "height": 740}, "has_touch": True}], indirect=True)
@pytest.mark.parametrize(
    "environment",
    [
        *("MountainCar-v0", "CartPole-v1", "CliffWalking-v1", "Taxi-v4", "Blackjack-v1", "grid"),
        "CartPole-v1&discretizer=fourier&order=2&counterexample=tdc",
    ],
)
def test_a_small_screen_needs_no_sideways_scrolling(window: Playground, environment: str) -> None:
    window.open(f"#env={environment}&episodes=30")
    window.page.locator("#settings-fold > summary").click()
    window.page.locator("details.more > summary").click()
    window.page.locator("#values").tap()
    window.settled()
    assert window.page.evaluate("() => document.documentElement.scrollWidth") <= 360
    wide = """() => [...document.querySelectorAll("main *, aside *, .top *")].filter((element) =>
      element.checkVisibility() && element.getBoundingClientRect().right > 361)
        .map((element) => element.outerHTML.slice(0, 80))"""
    assert window.page.evaluate(wide) == []
    low = """() => [...document.querySelectorAll("button, select, summary, input:not([type=checkbox])")]
      .filter((element) => element.checkVisibility() && element.getBoundingClientRect().height < 44)
      .map((element) => element.outerHTML)"""
    assert window.page.evaluate(low) == [], "too low for a finger"


@pytest.mark.parametrize(
    "window",
    [{"color_scheme": scheme, "viewport": {"width": 1280, "height": 900}} for scheme in ("light", "dark")],
    indirect=True,
    ids=["light", "dark"],
)
def test_text_has_enough_contrast(window: Playground) -> None:
    window.open("#env=grid&example=0&counterexample=tdc")
    assert window.page.evaluate(CONTRASTS) == []
    window.page.locator("#shortcuts-open").click()
    assert window.page.evaluate(CONTRASTS) == []


@pytest.mark.parametrize("window", [{"color_scheme": "dark"}], indirect=True, ids=["dark"])
def test_the_theme_follows_the_system_and_the_button(window: Playground) -> None:
    window.open("#env=CliffWalking-v1")
    paper = "() => getComputedStyle(document.body).backgroundColor"
    curve = "document.querySelector('#curve').toDataURL()"
    dark, pixels = window.page.evaluate(paper), window.page.evaluate(curve)
    button = window.page.locator("#theme")
    button.click()
    assert button.inner_text() == "Light colors"
    assert window.page.evaluate(paper) != dark
    window.page.wait_for_function(f"pixels => {curve} !== pixels", arg=pixels)
    button.click()
    assert window.page.evaluate(paper) == dark
    window.page.wait_for_function(f"pixels => {curve} === pixels", arg=pixels)
    button.click()
    assert button.inner_text() == "System colors"
    window.page.emulate_media(color_scheme="light")
    window.page.wait_for_function(f"({paper})() !== '{dark}'")
    window.page.wait_for_function(f"pixels => {curve} !== pixels", arg=pixels)


def test_every_environment_and_preset_has_an_example(playground: Playground) -> None:
    playground.open()
    examples = playground.page.evaluate("() => playground.EXAMPLES")
    for key, entry in definitions()["environments"].items():
        assert {example["preset"] for example in examples[key]} == set(entry["presets"])
        for example in examples[key]:
            assert len(example["look"]) > 40
            assert example["look"].endswith(".")


@pytest.mark.parametrize("width", [1280, 900, 390, 320])
def test_the_values_of_actions_stay_beside_or_above_the_updates(chromium: Any, page_file: Path, width: int) -> None:
    context = chromium.new_context(viewport={"width": width, "height": 900}, reduced_motion="reduce")
    opened = Playground(context, page_file).open("#env=MountainCar-v0&algorithm=double_q_learning")
    opened.page.evaluate(
        "() => { const { visits } = playground.view.result.map;"
        " playground.view.pick(visits.indexOf(Math.max(...visits)), 'key'); }"
    )
    opened.settled()
    edges = """() => {
      const box = (name) => document.querySelector(name).getBoundingClientRect();
      const [table, updates, panel] = [".action-values", ".updates", ".inspector"].map(box);
      return [table.right, table.bottom, updates.left, updates.top, updates.width, panel.right];
    }"""
    right, bottom, left, top, wide, border = opened.page.evaluate(edges)
    context.close()
    assert right < border
    assert right < left or bottom < top
    assert wide > 220

"""The examples of a task: which one is open, and when the settings are the reader's own."""

import pytest

from qtab.playground import definitions
from support.playground import Playground

pytestmark = pytest.mark.browser

PRESSED = """() => [...document.querySelectorAll("#examples button")].flatMap((button, index) =>
  button.getAttribute("aria-pressed") === "true" ? [index] : [])"""
OWN = "These are settings of your own. Choose an example to return to it."


def test_a_task_opens_with_its_first_example(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20")
    for environment in definitions()["environments"]:
        playground.page.locator(f'[data-environment="{environment}"]').click()
        assert playground.page.evaluate(PRESSED) == [0], environment
        assert playground.text("look") != OWN


def test_settings_that_are_changed_back_are_the_example_again(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=1")
    assert playground.page.evaluate(PRESSED) == [1]
    sentence = playground.text("look")
    playground.type_number("learning_rate", "0.25")
    assert playground.page.evaluate(PRESSED) == []
    assert playground.text("look") == OWN
    playground.type_number("learning_rate", "0.5")
    assert playground.page.evaluate(PRESSED) == [1]
    assert playground.text("look") == sentence
    playground.page.locator("#set-algorithm").select_option("q_learning")
    assert playground.page.evaluate(PRESSED) == [0]
    playground.settled()


def test_an_address_with_the_settings_of_an_example_opens_it(playground: Playground) -> None:
    playground.open("#env=CartPole-v1&example=1")
    settings = playground.state()["settings"]
    texts = {name: ",".join(map(str, value)) if isinstance(value, list) else value for name, value in settings.items()}
    playground.open("#env=CartPole-v1&" + "&".join(f"{name}={value}" for name, value in texts.items()))
    assert playground.page.evaluate(PRESSED) == [1]


def test_a_painted_grid_is_not_the_example_until_it_is_restored(playground: Playground) -> None:
    playground.open("#env=grid&example=0")
    playground.page.locator('[data-tool="#"]').click()
    for expected in ([], [0]):
        playground.page.locator(".map-cell").focus()
        for key in ("Home", "Enter"):
            playground.page.keyboard.press(key)
        playground.settled()
        assert playground.page.evaluate(PRESSED) == expected

"""Every control changes what it should, and nothing else."""

import json
from typing import Any

import pytest

from qtab.config.options import LEARNS_WEIGHTED
from qtab.playground import definitions
from qtab.playground.settings import OFFERED
from support.playground import Playground

pytestmark = pytest.mark.browser

KNOWN: dict[str, Any] = definitions()
ALL = {
    "MountainCar-v0": [
        {},
        {"algorithm": "sarsa_lambda"},
        {"algorithm": "n_step_sarsa"},
        {"algorithm": "dyna_q_plus"},
        {"learning_rate_schedule": "exponential"},
        {"epsilon_schedule": "exponential"},
        {"exploration": "softmax"},
        {"discretizer": "bins"},
        {"discretizer": "tiles"},
        {"discretizer": "fourier", "order": "2"},
    ]
}
SHORT = {"episodes": "20", "max_episode_steps": "30"}
NUMBERS = {"number", "integer"}


def open_short(playground: Playground, environment: str, settings: dict[str, Any]) -> None:
    given = {"env": environment, **SHORT, **settings}
    playground.open("#" + "&".join(f"{name}={value}" for name, value in given.items()))
    playground.page.locator("details.more > summary").click()


@pytest.mark.parametrize("settings", ALL["MountainCar-v0"], ids=json.dumps)
def test_every_control_changes_its_setting_and_trains_again(playground: Playground, settings: dict[str, Any]) -> None:
    open_short(playground, "MountainCar-v0", settings)
    names = playground.page.locator("[data-setting]").evaluate_all("all => all.map((each) => each.dataset.setting)")
    assert set(names) == set(playground.state()["settings"]), "a setting has no control"
    for name in names:
        settings_before = playground.state()["settings"]
        trained = playground.page.evaluate("() => playground.training.id")
        if (changed := _change(playground, name, settings_before[name])) is None:
            continue
        assert playground.state()["settings"][name] == changed, name
        assert playground.page.evaluate("() => playground.training.id") > trained, name
        playground.settled()
        playground.page.evaluate("(settings) => playground.store.update({ settings })", settings_before)
        playground.settled()


def _change(playground: Playground, name: str, before: Any) -> Any:
    """Operates the control of a setting as a reader would; returns the value that it should now have.

    None for a choice whose other names are all disabled.
    """
    page, definition = playground.page, KNOWN["settings"][name]
    if definition["type"] == "choice":
        select = page.locator(f"#set-{name}")
        others = select.locator("option:not([disabled])").evaluate_all("all => all.map((each) => each.value)")
        other: str | None = next((value for value in others if value != before), None)
        if other is not None:
            select.select_option(other)
        return other
    if definition["type"] == "flag":
        page.locator(f"#set-{name}").click()
        return not before
    if definition["type"] in NUMBERS:
        slider = page.locator(f"#slide-{name}")
        moved = int(slider.input_value())
        slider.press("ArrowLeft" if moved > 500 else "ArrowRight")
        after = playground.state()["settings"][name]
        assert after != before, name
        return after
    field = page.locator(f"#set-{name}-0")
    value = float(field.input_value())
    first = value - 0.01 if name == "low" else value + (1 if definition["type"] == "integers" else 0.25)
    field.fill(f"{first:g}")
    field.press("Enter")
    if definition["type"] == "initial_q":
        _, high = before if isinstance(before, list) else (before, before)
        return [first, high] if first < high else first
    assert isinstance(before, list)
    count = len(KNOWN["environments"]["MountainCar-v0"]["observations"])
    spread = before if len(before) == count else before * count
    return [first, *spread[1:]]


def test_a_fourier_basis_has_its_own_learning_rate_and_says_what_it_cannot_be_used_with(playground: Playground) -> None:
    open_short(playground, "MountainCar-v0", {"learning_rate": "0.3", "discretizer": "tiles"})
    before = playground.state()["settings"]
    discretizers = playground.page.locator("#set-discretizer")
    discretizers.select_option("fourier")
    assert playground.settled().state()["settings"].items() >= {"learning_rate": 0.001, "initial_q": 0}.items()
    # A quarter of the way from 0.0001 to 1, by orders of magnitude.
    assert playground.page.locator("#slide-learning_rate").input_value() == "250"
    for typed, key, expected in (("0.0001", "ArrowLeft", 0.00009), ("0", "ArrowRight", 0.00001)):
        playground.type_number("learning_rate", typed)
        playground.page.locator("#slide-learning_rate").press(key)
        assert playground.state()["settings"]["learning_rate"] == expected
    refused = playground.page.locator("#set-algorithm option:disabled").all_inner_texts()
    assert len(refused) == len({*OFFERED["algorithm"]} - {*LEARNS_WEIGHTED})
    assert all(text.endswith(" (not with Fourier basis)") for text in refused), refused
    playground.page.locator("#set-algorithm").select_option("sarsa_lambda")
    assert playground.settled().state()["settings"]["traces"] == "accumulating"
    refused = playground.page.locator("#set-traces option:disabled").all_text_contents()
    assert refused == ["Replacing (not with Fourier basis)", "Clearing (not with Fourier basis)"]
    discretizers.select_option("bins")
    after = playground.settled().state()["settings"]
    assert [after[name] for name in ("learning_rate", "initial_q")] == [0.3, before["initial_q"]]
    playground.page.locator("#set-algorithm").select_option("dyna_q")
    assert discretizers.locator('[value="fourier"]').inner_text() == "Fourier basis (not with Dyna-Q)"


def test_a_setting_changes_what_is_learned(playground: Playground) -> None:
    open_short(playground, "MountainCar-v0", {"initial_q": "0"})
    before = playground.result()
    playground.type_number("discount", "0.5")
    after = playground.settled().result()
    assert after["returns"] != before["returns"] or after["values"] != before["values"]
    playground.type_number("episodes", "35")
    assert playground.settled().result()["done"] == 35


def test_a_burst_of_slider_events_ends_in_the_result_of_the_last(playground: Playground) -> None:
    playground.open("#env=MountainCar-v0&example=0")
    playground.page.evaluate(
        """() => {
          const slider = document.querySelector("#slide-learning_rate");
          for (let index = 1; index <= 20; index++) {
            slider.value = 40 * index;
            slider.dispatchEvent(new Event("input", { bubbles: true }));
          }
        }"""
    )
    burst = playground.settled().result()
    rate = playground.state()["settings"]["learning_rate"]
    assert rate == 0.8
    playground.open("#env=MountainCar-v0&example=0")
    playground.type_number("learning_rate", str(rate))
    assert playground.settled().result() == burst


@pytest.mark.parametrize(
    ("setting", "typed", "message"),
    [
        ("learning_rate", "1e999", "learning_rate must be finite"),
        ("learning_rate", "nan", "learning_rate must be a number"),
        ("learning_rate", "1.5", "learning_rate must be in [0, 1]"),
        ("discount", "-0.1", "discount must be in [0, 1]"),
        ("episodes", "2.5", "episodes must be an integer"),
        ("episodes", "", "episodes must be an integer"),
        ("initial_q-0", "Infinity", "initial_q (from) must be a number"),
    ],
)
def test_bad_numbers_are_refused_by_name(playground: Playground, setting: str, typed: str, message: str) -> None:
    open_short(playground, "MountainCar-v0", {})
    before = playground.state()["settings"]
    playground.type_number(setting, typed)
    refused = playground.page.locator(f"#refused-{setting.removesuffix('-0')}")
    assert message in refused.inner_text()
    assert playground.page.locator(f"#set-{setting}").get_attribute("aria-invalid") == "true"
    assert playground.state()["settings"] == before


def test_impossible_combinations_are_disabled_with_the_reason(playground: Playground) -> None:
    open_short(playground, "MountainCar-v0", {"discretizer": "tiles"})
    option = playground.page.locator('#set-algorithm option[value="dyna_q"]')
    assert option.is_disabled()
    assert "not with Tile coding" in option.inner_text()
    playground.page.locator("#set-discretizer").select_option("bins")
    playground.settled()
    assert not option.is_disabled()
    playground.page.locator("#set-algorithm").select_option("dyna_q")
    playground.settled()
    tiles = playground.page.locator('#set-discretizer option[value="tiles"]')
    assert tiles.is_disabled()
    assert "not with Dyna-Q" in tiles.inner_text()


@pytest.mark.parametrize(
    ("fragment", "alpha", "epsilon"),
    [
        ("example=1", "→ 0", ""),
        ("learning_rate_schedule=constant&epsilon=0.8&epsilon_schedule=linear&min_epsilon=0.1", "", "→ 0.1"),
        ("learning_rate=0.5&learning_rate_schedule=linear&min_learning_rate=0.5&epsilon_schedule=constant", "", ""),
        # 0.5 · 0.9^(20 − 1 − 4), and 0.8 · 0.5^19, which is below the lowest ε
        (
            "episodes=20&learning_rate=0.5&learning_rate_schedule=exponential&learning_rate_decay=0.9"
            "&learning_rate_warm_up=4&epsilon=0.8&epsilon_schedule=exponential&epsilon_decay=0.5&min_epsilon=0.05",
            "→ 0.103",
            "→ 0.05",
        ),
        ("learning_rate=1&learning_rate_schedule=visits&min_learning_rate=0.05", "/ visits, ≥ 0.05", "→ 0"),
    ],
)
def test_what_a_rate_falls_to_stands_beside_it(playground: Playground, fragment: str, alpha: str, epsilon: str) -> None:
    playground.open(f"#env=FrozenLake-v1&{fragment}")
    for name, text in (("learning_rate", alpha), ("epsilon", epsilon)):
        place = playground.page.locator(f"#falling-{name}")
        assert place.inner_text() == text
        assert place.is_visible() == (text != "")
        assert f"falling-{name} " in str(playground.page.locator(f"#set-{name}").get_attribute("aria-describedby"))

"""Baird's counterexample: the page's weights equal Python's, and the panel shows them."""

import math
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import pytest

from qtab.book.figures.chapter_11.baird import DISCOUNT, INITIAL_WEIGHTS, geometry
from qtab.envs.book.baird_counterexample import STATES, BairdCounterexampleEnv
from qtab.prediction.linear import expected_updates
from support.playground import Playground

pytestmark = pytest.mark.browser

Weights: TypeAlias = list[float]
SHARE = 1 / STATES
X: list[Weights] = BairdCounterexampleEnv().features.tolist()
LOWER = X[-1]
STEP_SIZES: dict[str, Any] = {"td": (0.01, None), "tdc": (0.005, 0.05), "emphatic_td": (0.03, None)}
"""Those of Figures 11.2, 11.5 and 11.6."""


def total(numbers: Any) -> float:
    """Returns a sum from left to right."""
    result = 0.0
    for number in numbers:
        result += number
    return result


def values(w: Weights) -> Weights:
    return [total(weight * number for weight, number in zip(w, x, strict=True)) for x in X]


def errors(w: Weights) -> Weights:
    v = values(w)
    return [DISCOUNT * v[-1] - value for value in v]


def weighted(emphases: Weights, deltas: Weights) -> Weights:
    return [
        total(emphasis * delta * x[index] for emphasis, delta, x in zip(emphases, deltas, X, strict=True))
        for index in range(STATES + 1)
    ]


def moved(w: Weights, alpha: float, direction: Weights) -> Weights:
    return [weight + alpha * change for weight, change in zip(w, direction, strict=True)]


def td(alpha: float, _: Any) -> Callable[[Weights], Weights]:
    return lambda w: moved(w, alpha, weighted([SHARE] * STATES, errors(w)))


def tdc(alpha: float, beta: float) -> Callable[[Weights], Weights]:
    v = [0.0] * (STATES + 1)

    def update(w: Weights) -> Weights:
        deltas, corrections = errors(w), values(v)
        descent = weighted([SHARE] * STATES, deltas)
        correction = total(SHARE * each for each in corrections)
        rest = [delta - each for delta, each in zip(deltas, corrections, strict=True)]
        v[:] = moved(v, beta, weighted([SHARE] * STATES, rest))
        return moved(w, alpha, [each - DISCOUNT * correction * x for each, x in zip(descent, LOWER, strict=True)])

    return update


def emphatic_td(alpha: float, _: Any) -> Callable[[Weights], Weights]:
    emphases = [0.0] * STATES

    def update(w: Weights) -> Weights:
        emphases[:] = [SHARE] * (STATES - 1) + [SHARE + DISCOUNT * total(emphases)]
        return moved(w, alpha, weighted(emphases, errors(w)))

    return update


METHODS = {"td": td, "tdc": tdc, "emphatic_td": emphatic_td}


@pytest.mark.parametrize("method", METHODS)
def test_the_weights_of_the_page_are_those_of_python_to_the_last_bit(playground: Playground, method: Any) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20")
    alpha, beta = STEP_SIZES[method]
    for factor in (1, 0.3, 7):
        arguments = [method, 1000, alpha * factor, beta]
        found = playground.page.evaluate("arguments => playground.expectedUpdates(...arguments)", arguments)
        update, w = METHODS[method](alpha * factor, beta), list(map(float, INITIAL_WEIGHTS))
        for sweep, shown in enumerate(found):
            assert list(map(float.hex, map(float, shown))) == list(map(float.hex, w)), (factor, sweep)
            w = update(w)
        assert len(found) == 1001
        options = {} if beta is None else {"second_learning_rate": beta}
        weights = expected_updates(geometry(), method, 1000, alpha * factor, initial_weights=INITIAL_WEIGHTS, **options)
        # NumPy adds in another order.
        np.testing.assert_allclose(found, weights, rtol=1e-9, atol=1e-9)


def test_an_address_opens_the_panel_and_follows_its_method(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20&counterexample=tdc")
    page = playground.page
    panel = page.locator("#counterexample")
    page.wait_for_function("() => document.querySelector('[data-method=tdc]')?.ariaChecked === 'true'")
    trained = page.evaluate("() => playground.training.id")
    page.locator('[data-method="emphatic_td"]').click()
    page.wait_for_function("() => location.hash.includes('counterexample=emphatic_td')")
    page.evaluate("() => { location.hash = '#env=CliffWalking-v1&episodes=20&counterexample=td'; }")
    page.wait_for_function("() => document.querySelector('[data-method=td]').ariaChecked === 'true'")
    playground.settled()
    assert page.evaluate("() => playground.training.id") == trained + 1
    page.evaluate("() => { location.hash = '#env=CliffWalking-v1&episodes=20'; }")
    page.wait_for_function("() => !document.querySelector('#counterexample').open")
    panel.locator("summary").click()
    page.wait_for_function("() => location.hash.includes('counterexample=td')")
    panel.locator("summary").click()
    page.wait_for_function("() => !location.hash.includes('counterexample')")
    playground.open("#env=CliffWalking-v1&episodes=20&counterexample=nothing")
    assert playground.text("problem").endswith("left out or changed: counterexample.")
    assert panel.get_attribute("open") is None


def test_the_panel_shows_what_each_method_does(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20")
    page = playground.page
    page.locator("#counterexample > summary").click()
    summary, pictures = page.locator("#counterexample figcaption").last, page.locator("#counterexample canvas")
    assert summary.inner_text() == ("After 1,000 sweeps: w₁ to w₆ = 114.4, w₇ = 6.85, w₈ = 335, √VE = 581.4.")
    assert page.locator("#counterexample-beta").is_hidden()
    before = pictures.nth(1).screenshot()
    for method, error in (("tdc", "1.935"), ("emphatic_td", "4.58e−13")):
        page.locator(f'[data-method="{method}"]').click()
        assert summary.inner_text().endswith(f"√VE = {error}.")
        assert page.locator("#counterexample-beta").is_visible() == (method == "tdc")
    assert pictures.nth(1).screenshot() != before
    page.locator('[data-method="td"]').click()
    for _ in range(3):
        page.locator("#counterexample-sweeps").press("PageDown")
    sweeps = int(page.locator("#counterexample-sweeps").input_value())
    assert sweeps < 1000
    assert summary.inner_text().startswith(f"After {sweeps} sweeps: ")
    page.locator("#counterexample-alpha").press("End")
    assert "Step size α" in page.locator("#counterexample .rates").inner_text()
    weights = expected_updates(geometry(), "td", sweeps, 0.2, initial_weights=INITIAL_WEIGHTS)
    shown = float(summary.inner_text().split("√VE = ")[1].rstrip("."))
    assert shown == pytest.approx(math.sqrt(geometry().value_error(weights[-1])), rel=1e-2)

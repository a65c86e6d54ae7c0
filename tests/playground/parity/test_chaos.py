"""Acrobot: its motion makes a difference in the last bit of a sine grow, so the page promises another thing there."""

import math

import numpy as np
import pytest

import qtab
from qtab.playground import definitions
from support.playground import Playground

pytestmark = pytest.mark.browser

EXAMPLE = "#env=Acrobot-v1&example=0&episodes=200"
SHOWN = """() => ["footer", "#python-dialog"].map((place) =>
  [...document.querySelectorAll(`${place} [data-claim]`)]
    .filter((claim) => !claim.hidden).map((claim) => claim.textContent.replace(/\\s+/g, " ")))"""
DIGEST = """async () => new Uint32Array((await playground.engine.table(0)).buffer)
  .reduce((digest, word) => Math.imul(digest ^ word, 16777619), 2166136261)"""
"""A number that follows from all bits of the table of the first seed."""


def test_only_acrobot_is_said_to_part_from_python(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20")
    for environment in definitions()["environments"]:
        playground.page.locator(f'[data-environment="{environment}"]').click()
        [footer], [dialog] = playground.page.evaluate(SHOWN)
        is_acrobot = environment == "Acrobot-v1"
        assert ("in Python gives the same table, to the last bit" in footer) != is_acrobot
        assert ("learns the same table as this page" in dialog) != is_acrobot
        assert ("Acrobot is chaotic" in footer) == ("Acrobot is chaotic" in dialog) == is_acrobot


def test_a_fourier_basis_is_said_to_differ_from_python_in_the_last_digits(playground: Playground) -> None:
    playground.open("#env=MountainCar-v0&episodes=20&discretizer=fourier")
    [footer], [dialog] = playground.page.evaluate(SHOWN)
    assert "gives the same weights, apart from their last digits" in footer
    assert "learns the same weights as this page, apart from their last digits" in dialog
    playground.page.locator("#set-discretizer").select_option("tiles")
    [footer], [dialog] = playground.page.evaluate(SHOWN)
    assert "in Python gives the same table, to the last bit" in footer


@pytest.mark.slow
def test_a_page_learns_the_same_twice_and_as_well_as_python(playground: Playground) -> None:
    pages = []
    for seeds in ("&seed=1", "", "&seeds=16"):
        playground.open(f"{EXAMPLE}{seeds}")
        pages.append((playground.page.evaluate(DIGEST), playground.result()["returns"]))
    returns = np.reshape(pages[2][1], (16, -1))
    assert pages[1] == (pages[2][0], returns[0].tolist())
    assert pages[0][0] != pages[1][0]
    settings = playground.state()["settings"]
    settings = {name: tuple(value) if isinstance(value, list) else value for name, value in settings.items()}
    in_python = qtab.train_many("Acrobot-v1", seeds=range(16), **settings).episode_returns
    first = [np.flatnonzero(one != other)[:1] for one, other in zip(returns, in_python, strict=True)]
    assert sum(len(episode) for episode in first) > 8, "the runs do not part, as the page says"
    assert np.median(np.concatenate(first)) < 50
    for part in (slice(0, 100), slice(100, 200)):
        means = [learned[:, part].mean(axis=1) for learned in (returns, in_python)]
        error = math.hypot(*(np.std(each, ddof=1) / 4 for each in means))
        assert abs(np.mean(means[0]) - np.mean(means[1])) < 4 * error, "four standard errors"
    assert returns[:, :10].mean() < -250
    assert returns[:, 150:].mean() > -130

"""Asks the search of the built site obvious questions in Chromium: the page that answers is among the first results."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

FIRST = 3
"""The page must be among this many first results."""
ENOUGH = """
count => document.querySelectorAll("#search-results ul.search > li").length >= count
    || document.querySelector("#search-results h2")?.textContent === "Search Results"
"""
"""Whether a search has shown a number of results, or all that there are."""

EXPECTED = {
    # environments, in both spellings
    "frozen lake": "walkthroughs/frozen_lake",
    "FrozenLake-v1": "walkthroughs/frozen_lake",
    "cliff walking": "walkthroughs/cliff_walking",
    "CliffWalking": "walkthroughs/cliff_walking",
    "taxi": "walkthroughs/taxi",
    "cart pole": "walkthroughs/cart_pole",
    "CartPole-v1": "walkthroughs/cart_pole",
    "blackjack": "walkthroughs/blackjack",
    "lunar lander": "walkthroughs/lunar_lander",
    "LunarLander-v3": "walkthroughs/lunar_lander",
    "mountain car": "tutorial/first_run",
    "environments": "reference/environments",
    # other software and hardware
    "colab": "reference/faq",
    "binder": "reference/faq",
    "gpu": "reference/faq",
    "neural network": "reference/faq",
    "stable baselines": "how_to/stable_baselines3",
    "Stable-Baselines3": "how_to/stable_baselines3",
    "gymnasium": "how_to/drop_in",
    "windows": "reference/platforms",
    "cluster": "how_to/cluster",
    "optuna": "how_to/sweeps",
    # subjects
    "install": "install",
    "tile coding": "how_to/spaces",
    "q learning": "tutorial/from_nothing",
    "monte carlo": "walkthroughs/blackjack",
    "action mask": "how_to/actions",
    "own environment": "how_to/own_environment",
    "epsilon": "reference/choices",
    "exercises": "exercises/index",
    "notebooks": "tutorial/index",
    "speed": "explanation/speed",
    "qtab.train": "reference/api/generated/qtab.train",
}
"""The page for each query."""


def problems(site: Path) -> Iterator[str]:
    """Yields a line for each query whose page is not among the first results."""
    from browser import browsed

    with browsed(site) as (page, address):
        for query, expected in EXPECTED.items():
            found = results(page, address, query)
            if expected not in found:
                yield f"search for {query!r}: {expected} is not among the first results, {', '.join(found) or 'none'}"


def results(page: Any, address: str, query: str) -> list[str]:
    """Returns the pages of the first results of a search, as names in the documentation."""
    page.goto(f"{address}search.html?q={quote(query)}")
    page.wait_for_function(ENOUGH, arg=FIRST)
    links = page.locator("#search-results ul.search > li > a").evaluate_all("all => all.map(link => link.pathname)")
    found = [link.removeprefix("/").removesuffix(".html") for link in links]
    return found[:FIRST]

"""Makes the search find what readers type.

- A name is indexed in both spellings: ``FrozenLake`` also as *frozen lake*, and *frozen lake* also as ``FrozenLake``.
- ``search_words.json`` lists phrases for some pages and sections, such as *gpu*. For these phrases they come before all
  other results.
"""

import json
import re
from itertools import pairwise
from pathlib import Path

import gymnasium as gym
from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.search.en import SearchEnglish

PHRASES = Path(__file__).with_suffix(".json")
PART = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+")
NAMES = {spec.name.lower() for spec in gym.registry.values()}
"""Names of environments in one word, such as ``frozenlake``."""


class BothSpellings(SearchEnglish):
    """English, with names as a whole and in parts."""

    def split(self, input: str) -> list[str]:  # noqa: A002 - the name in the base class
        """Returns the words of a text, the parts of names such as ``FrozenLake``, and names that were in parts."""
        words = super().split(input)
        parts = [part for word in words for part in PART.findall(word) if part != word]
        pairs = [first + second for first, second in pairwise(words)]
        return [*words, *parts, *(pair for pair in pairs if pair.lower() in NAMES)]


def read_phrases(app: Sphinx) -> None:
    """Reads the phrases, and checks that their pages exist.

    Raises:
        ExtensionError: for a page that does not exist.
    """
    phrases = json.loads(PHRASES.read_text(encoding="utf-8"))
    if missing := {place.partition("#")[0] for place in phrases} - app.project.discover():
        raise ExtensionError(f"{PHRASES.name} names pages that do not exist: {', '.join(sorted(missing))}")
    app.env.search_phrases = phrases


def add_phrases(app: Sphinx, doctree: nodes.document) -> None:
    """Adds the phrases of a page and its sections to the search index, but not to the general index.

    Raises:
        ExtensionError: for a section that does not exist.
    """
    for place, phrases in app.env.search_phrases.items():
        page, _, section = place.partition("#")
        if page != app.env.docname:
            continue
        if section and section not in doctree.ids:
            raise ExtensionError(f"{PHRASES.name} names a section that does not exist: {place}")
        entries = [("single", phrase, section, "main", None) for phrase in phrases]
        doctree.insert(0, addnodes.index(entries=entries))


def setup(app: Sphinx) -> dict[str, bool]:
    """Registers the language and the phrases."""
    app.add_search_language(BothSpellings)
    app.connect("builder-inited", read_phrases, priority=200)
    app.connect("doctree-read", add_phrases)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

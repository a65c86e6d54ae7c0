"""The versions of the software that trained the runs of a store, and their texts in messages and reports."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence, Set
from contextlib import suppress
from typing import Any

from qtab._utils.shown import counted
from qtab._utils.versions import versions

Versions = Mapping[str, str] | None
"""The versions by name, as :func:`qtab._utils.versions.versions` returns them; None if unknown."""
UNKNOWN = -1
"""The place for runs whose versions an earlier version of this package did not store."""
SHOWN_VALUES = 5
"""The maximum number of versions of the same software to show in messages."""


def named_versions(meta: Mapping[str, str]) -> list[Any]:
    """Returns the versions named in a store: those of the process that created it, and of others that trained runs.

    Raises:
        ValueError: if they are not JSON.
    """
    try:
        return [json.loads(meta.get("versions", "{}")), *json.loads(meta.get("other_versions", "[]"))]
    except (TypeError, RecursionError) as error:
        raise ValueError(f"its versions are not JSON: {error}") from None


def check_places(meta: Mapping[str, str], places: Set[Any]) -> None:
    """Checks that the versions of runs are named in their store.

    Raises:
        ValueError: if they are not.
    """
    named = [None, *named_versions(meta)] if places - {UNKNOWN} else [None]
    for place in places:
        if not (type(place) is int and UNKNOWN <= place < len(named) - 1):
            raise ValueError(f"its runs have the versions {place!r:.40}, which it does not name")
        one = named[place + 1]
        if place != UNKNOWN and not (isinstance(one, dict) and all(isinstance(text, str) for text in one.values())):
            raise ValueError("its versions are not texts")


def versions_of_runs(meta: Mapping[str, str], places: Sequence[int]) -> list[Versions]:
    """Returns the versions of each run of a checked store."""
    if all(place == UNKNOWN for place in places):
        return [None] * len(places)
    named = [*named_versions(meta), None]  # the last one is at the place UNKNOWN
    return [named[place] for place in places]


def other_versions(meta: Mapping[str, str], places: Sequence[int]) -> list[str]:
    """Returns the versions that trained a store's runs and differ from those here; if unknown, all that it names."""
    trained: list[Any] = []
    if UNKNOWN not in places:
        trained = versions_of_runs(meta, sorted(set(places)))
    else:
        with suppress(ValueError):
            trained = named_versions(meta)
    return list(dict.fromkeys(other for one in trained if isinstance(one, dict) for other in differing(one)))


def differing(trained: Versions) -> list[str]:
    """Returns the names and versions that differ from those here; none if they are unknown."""
    here = versions()
    return [f"{name} {trained.get(name)}" for name in here if trained.get(name) != here[name]] if trained else []


def runs_by_versions(of_runs: Sequence[Versions]) -> list[tuple[Versions, int]]:
    """Returns the different versions with the number of their runs, the most frequent first."""
    distinct = {id(one): one for one in of_runs}
    found: dict[str, tuple[Versions, int]] = {}
    for key, runs in Counter(map(id, of_runs)).items():
        text = json.dumps(distinct[key], sort_keys=True)
        found[text] = (distinct[key], runs + (found[text][1] if text in found else 0))
    return sorted(found.values(), key=lambda pair: -pair[1])


def by_name(of_runs: Sequence[Versions]) -> dict[str, list[tuple[str, int]]]:
    """Returns the versions of each software by name, with the number of their runs, the most frequent first."""
    values: dict[str, Counter[str]] = {}
    for one, runs in runs_by_versions(of_runs):
        for name, value in (one or {}).items():
            values.setdefault(name, Counter())[value] += runs
    return {name: counter.most_common() for name, counter in values.items()}


def different_versions(of_runs: Sequence[Versions]) -> dict[str, list[tuple[str, int]]]:
    """Returns the entries of :func:`by_name` with more than one version."""
    return {name: values for name, values in by_name(of_runs).items() if len(values) > 1}


def versions_note(of_runs: Sequence[Versions]) -> str:
    """Returns sentences about different versions of runs and the number of runs without any; "" if there are none."""
    notes = []
    if differ := different_versions(of_runs):
        parts = [f"{name} {in_words(values)}" for name, values in differ.items()]
        notes.append(f"The runs were trained with different versions: {'; '.join(parts)}.")
    unknown = sum(runs for one, runs in runs_by_versions(of_runs) if one is None)
    if unknown:
        runs, them = counted(unknown, "run"), "it" if unknown == 1 else "them"
        notes.append(f"An earlier version of qtab stored {runs} without the versions that trained {them}.")
    return " ".join(notes)


def in_words(values: Sequence[tuple[str, int]]) -> str:
    """Returns text with the versions of one software and the numbers of their runs."""
    shown = [f"{value} ({counted(runs, 'run')})" for value, runs in values[:SHOWN_VALUES]]
    left = len(values) - SHOWN_VALUES
    return ", ".join([*shown, f"and {left} more"] if left > 0 else shown)

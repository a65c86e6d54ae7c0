"""Stores of format version 1, which have no digests: the check of their chunks."""

import sqlite3
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from qtab.sweeps.connection import damaged
from qtab.sweeps.database import Contents
from qtab.sweeps.description import Description

_STEPS = {"rust": 2**26, "gymnasium": 2**16}
"""The estimated steps of a chunk, by backend."""
_TYPICAL_MAX_STEPS = 1000
_MAX_RUNS = 4096


def check_chunks(connection: sqlite3.Connection, path: Path | None, contents: Contents) -> None:
    """Checks that the runs are those of the finished chunks.

    Raises:
        StoreError: if runs are missing, or belong to none.
    """
    description = contents.description
    done = [row[0] for row in connection.execute("SELECT piece FROM pieces WHERE done ORDER BY piece")]
    numbers = [row[0] for row in connection.execute("SELECT piece FROM pieces ORDER BY piece")]
    chunks = _chunks(description)
    if numbers != list(range(len(numbers))) or not numbers:
        raise damaged(path, "the numbers of its chunks have gaps")
    expected: set[int] = set()
    if len(numbers) == len(chunks):
        expected = {run for number in done for run in chunks[number]}
    elif len(done) == len(numbers):  # chunks of another size, but all of them
        expected = set(range(description.runs))
    else:
        return
    found = {run[0] for run in contents.runs}
    if found != expected:
        what = f"run {min(expected - found)} is missing" if expected - found else "it has runs of unfinished chunks"
        raise damaged(path, f"{what}, going by its finished chunks")


def _chunks(description: Description) -> list[range]:
    """Returns the chunks into which version 1 divides a study: it estimates the work of each run from its settings."""
    chunks: list[range] = []
    start, work, count = 0, 0.0, len(description.seeds)
    for run in range(description.runs):
        if work >= 1 or run - start >= _MAX_RUNS:
            chunks.append(range(start, run))
            start, work = run, 0.0
        work += _work(description.configs[run // count])
    return [*chunks, range(start, description.runs)]


def _work(config: Mapping[str, Any]) -> float:
    steps = config["episodes"] * min(config["max_episode_steps"], _TYPICAL_MAX_STEPS)
    return float(steps / _STEPS.get(config.get("backend", ""), 2**26))

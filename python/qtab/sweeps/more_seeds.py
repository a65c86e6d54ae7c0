"""More seeds for a store: its runs are numbered by setting and seed, so that all of them get new numbers."""

import sqlite3
from pathlib import Path

from qtab.sweeps.database import about_itself, read_contents, replace_runs
from qtab.sweeps.description import Description
from qtab.sweeps.digests import StoredRun
from qtab.sweeps.stored import check_study


def numbering(connection: sqlite3.Connection) -> int:
    """Returns how often the runs of a store were numbered."""
    return int(connection.execute("PRAGMA user_version").fetchone()[0])


def add_seeds(connection: sqlite3.Connection, path: Path | None, description: Description) -> None:
    """Gives a store the seeds of a study, in a transaction. Processes that use it with its old seeds must stop.

    Raises:
        StoreError: if the store is damaged, or belongs to another study.
    """
    contents = read_contents(connection, path)
    check_study(contents, description, path)
    old, new = contents.description.seeds, description.seeds
    if old == new:
        return  # another process was faster
    places = {seed: place for place, seed in enumerate(new)}

    def renumbered(stored: StoredRun) -> StoredRun:
        setting, place = divmod(stored[0], len(old))
        return (setting * len(new) + places[old[place]], *stored[1:])

    pairs = sorted(zip(map(renumbered, contents.runs), contents.places, strict=True), key=lambda pair: int(pair[0][0]))
    runs, of_runs = [run for run, _ in pairs], [place for _, place in pairs]
    replace_runs(connection, runs, of_runs, contents.seconds, {**about_itself(contents), "study": description.text})
    connection.execute(f"PRAGMA user_version = {(numbering(connection) + 1) % 2**31}")

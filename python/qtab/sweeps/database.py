"""The SQLite file format of a store: its tables, the check of its version and content, and how runs are written."""

import json
import math
import sqlite3
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from qtab.sweeps.connection import StoreError, damaged, name_of
from qtab.sweeps.description import SUMMARY_COLUMNS, Description, read_description
from qtab.sweeps.digests import StoredRun, chunk_digest, combined, study_digest, to_text
from qtab.sweeps.run_versions import UNKNOWN, check_places, named_versions

FORMAT = "qtab sweep"
FORMAT_VERSION = 3
"""The version that is written. Version 2, which lacks the versions of single runs, is also read, and upgraded when its
sweep resumes."""

_META = "CREATE TABLE meta (name TEXT PRIMARY KEY, value TEXT NOT NULL)"
_RUNS = (
    f"CREATE TABLE runs ( run INTEGER PRIMARY KEY, seed TEXT NOT NULL, "
    f"{', '.join(f'{name} REAL' for name in SUMMARY_COLUMNS)}, curve BLOB NOT NULL, error TEXT )"
)
_CHUNKS = (
    "CREATE TABLE chunks (start INTEGER PRIMARY KEY, stop INTEGER NOT NULL, owner TEXT, heartbeat REAL, seconds REAL, "
    "digest TEXT, versions INTEGER, CONSTRAINT needs_newer_qtab CHECK (digest IS NULL OR versions IS NOT NULL))"
)
"""The runs ``start`` to ``stop`` - 1. With a digest they are stored; without, ``owner`` has claimed them, at the time
``heartbeat``. ``versions`` is the place of the software that trained them among those that the store names.

The constraint refuses what an earlier qtab would store that opened the file before another process upgraded it: such a
process does not notice that the runs have other numbers after more seeds were added."""
_CHUNKS_2 = (
    "CREATE TABLE chunks (start INTEGER PRIMARY KEY, stop INTEGER NOT NULL, owner TEXT, heartbeat REAL, seconds REAL, "
    "digest TEXT)"
)
_TABLES = {"2": {_META, _CHUNKS_2, _RUNS}, "3": {_META, _CHUNKS, _RUNS}}
_RUN_COLUMNS = f"run, seed, {', '.join(SUMMARY_COLUMNS)}, curve, error"


@dataclass(frozen=True)
class RunRecord:
    """A run to be stored: its summary and learning curve, or the error with which it failed."""

    seed: int
    summary: dict[str, float | int] | None
    """A value for each of ``SUMMARY_COLUMNS``; None if the run failed."""
    curve: bytes
    """(blocks,) float64: the mean return of each whole block of episodes."""
    error: str | None = None

    def as_row(self, run: int) -> StoredRun:
        """Returns the row of the table ``runs`` for the run with this index, as SQLite returns it when it is read."""
        # SQLite does not store the sign of zero, nor lone surrogates.
        values = [None if self.summary is None else float(self.summary[name]) + 0.0 for name in SUMMARY_COLUMNS]
        error = None if self.error is None else self.error.encode(errors="replace").decode()
        return (run, str(self.seed), *values, self.curve, error)


@dataclass(frozen=True)
class Contents:
    """What a store holds, after it was checked."""

    meta: dict[str, str]
    description: Description
    runs: list[StoredRun]
    seconds: float
    """The time that the chunks took, in seconds of their workers."""
    places: Sequence[int]
    """For each run, the place of the versions that trained it in :func:`qtab.sweeps.run_versions.named_versions`;
    ``UNKNOWN`` where an earlier version did not store it."""


def is_empty(connection: sqlite3.Connection) -> bool:
    """Returns whether the file has no tables."""
    return not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]


def create_tables(connection: sqlite3.Connection, description: Description, versions: Mapping[str, str]) -> None:
    """Creates the tables for a study.

    Args:
        connection: The connection, in a transaction.
        description: The study.
        versions: The versions of the process that creates the store.
    """
    for statement in sorted(_TABLES[str(FORMAT_VERSION)]):
        connection.execute(statement)
    content = {"study": description.text, "versions": json.dumps(versions)}
    if description.environments is not None:
        content["environments"] = description.environments
    write_meta(connection, content, [])


def write_meta(connection: sqlite3.Connection, content: dict[str, str], chunks: Sequence[int]) -> None:
    """Writes what a store says about itself, with the digest over it and the digests of its chunks."""
    meta = {"format": FORMAT, "version": str(FORMAT_VERSION), **content}
    meta["digest"] = to_text(combined(study_digest(meta), chunks))
    connection.execute("DELETE FROM meta")
    connection.executemany("INSERT INTO meta VALUES (?, ?)", meta.items())


def read_meta(connection: sqlite3.Connection, path: Path | None) -> dict[str, str]:
    """Returns what a store says about itself, after checking its format, its version and its tables.

    Raises:
        StoreError: if the file is not a store, has another format version, or has other tables, views or triggers.
    """
    schema = connection.execute("SELECT type, sql FROM sqlite_master").fetchall()
    # SQLite creates the index of a primary key; it has no text.
    statements = [" ".join(sql.split()) if isinstance(sql, str) else kind for kind, sql in schema]
    if _META not in statements:
        raise StoreError(f"{name_of(path)} is not a sweep store")
    rows = connection.execute("SELECT name, value FROM meta").fetchall()
    meta = {name: value for name, value in rows if isinstance(name, str) and isinstance(value, str)}
    if meta.get("format") != FORMAT or "study" not in meta or len(meta) < len(rows):
        raise StoreError(f"{name_of(path)} is not a sweep store")
    version = meta.get("version", "")
    if version not in _TABLES:
        raise StoreError(f"{name_of(path)} has format version {version!r:.40}, but this qtab reads 2 and 3")
    if set(statements) - {"index"} != _TABLES[version] or len(statements) != len(_TABLES[version]) + 1:
        raise damaged(path, "it has other tables, views or triggers than a store")
    return meta


def read_contents(connection: sqlite3.Connection, path: Path | None) -> Contents:
    """Returns what a store holds, after checking all of it.

    Raises:
        sqlite3.Error: if SQLite cannot read the file.
        StoreError: if the file is not a store, or is damaged.
    """
    meta = read_meta(connection, path)
    problem = connection.execute("PRAGMA integrity_check(1)").fetchone()[0]
    if problem != "ok":
        raise damaged(path, problem)
    runs = connection.execute(f"SELECT {_RUN_COLUMNS} FROM runs ORDER BY run").fetchall()  # noqa: S608 - fixed names
    try:
        description = read_description(meta["study"])
        for run, seed, *summary, curve, error in runs:
            if not 0 <= run < description.runs:
                raise ValueError(f"it has a run {run}, but its study has {description.runs} runs")
            try:
                description.check_run(run, seed, summary, curve, error)
            except ValueError as reason:
                raise ValueError(f"run {run}: {reason}") from None
        seconds, places = _check_chunks(connection, meta, description, runs)
        return Contents(meta, description, runs, seconds, places)
    except (ValueError, TypeError) as error:
        raise damaged(path, error) from error


def _check_chunks(
    connection: sqlite3.Connection, meta: dict[str, str], description: Description, runs: list[StoredRun]
) -> tuple[float, list[int]]:
    """Compares the runs with their digests.

    Returns:
        The time that the chunks took, in seconds, and the place of the versions of each run.
    """
    after, position, total = 0, 0, 0.0
    digests: list[int] = []
    places: list[int] = []
    place = str(UNKNOWN) if meta["version"] == "2" else "versions"
    query = f"SELECT start, stop, seconds, digest, {place} FROM chunks ORDER BY start"  # noqa: S608 - fixed names
    for start, stop, seconds, digest, versions in connection.execute(query):
        if not (type(start) is int and type(stop) is int and after <= start < stop <= description.runs):
            raise ValueError(f"its chunk of runs {start!r} to {stop!r} overlaps another or is none of its study")
        after = stop
        if digest is None:
            continue
        chunk = runs[position : position + stop - start]
        position += len(chunk)
        if [run[0] for run in chunk] != list(range(start, stop)):
            raise ValueError(f"runs are missing among {start} to {stop - 1}, which it says are finished")
        if not (isinstance(seconds, float) and math.isfinite(seconds)):
            raise ValueError(f"its chunk of runs {start} to {stop - 1} has no time")
        if not (type(versions) is int and -(2**63) <= versions < 2**63):
            raise ValueError(f"its chunk of runs {start} to {stop - 1} has no versions")
        expected = chunk_digest(start, stop, seconds, chunk, None if meta["version"] == "2" else versions)
        if digest != to_text(expected):
            raise ValueError(f"its runs {start} to {stop - 1} differ from their digest")
        digests.append(expected)
        places += [versions] * len(chunk)
        total += seconds
    if position < len(runs):
        raise ValueError(f"it has a run {runs[position][0]} that belongs to none of its finished chunks")
    if meta.get("digest") != to_text(combined(study_digest(meta), digests)):
        raise ValueError("its study or the number of its chunks differs from its digest")
    check_places(meta, set(places))
    return total, places


def read_runs(connection: sqlite3.Connection, runs: range) -> list[StoredRun]:
    """Returns those of consecutive runs that are stored, without checking them."""
    query = f"SELECT {_RUN_COLUMNS} FROM runs WHERE run >= ? AND run < ?"  # noqa: S608 - fixed names
    return connection.execute(query, (runs.start, runs.stop)).fetchall()


def insert_chunk(connection: sqlite3.Connection, rows: Sequence[StoredRun], seconds: float, place: int) -> int:
    """Stores consecutive runs, which took so many seconds, with the place of their versions; returns their digest."""
    placeholders = ", ".join("?" * (len(SUMMARY_COLUMNS) + 4))
    connection.executemany(f"INSERT INTO runs VALUES ({placeholders})", rows)  # noqa: S608 - placeholders only
    start, stop = rows[0][0], rows[-1][0] + 1
    digest = chunk_digest(start, stop, seconds, rows, place)
    connection.execute(
        "INSERT INTO chunks (start, stop, seconds, digest, versions) VALUES (?, ?, ?, ?, ?)",
        (start, stop, seconds, to_text(digest), place),
    )
    return digest


def replace_runs(
    connection: sqlite3.Connection,
    runs: Sequence[StoredRun],
    places: Sequence[int],
    seconds: float,
    content: dict[str, str],
) -> None:
    """Writes all that a store holds anew, in a transaction; claims are withdrawn.

    Args:
        connection: The connection.
        runs: The runs in their order.
        places: For each run, the place of its versions.
        seconds: The time that they took.
        content: What the store says about itself, as for :func:`write_meta`.
    """
    connection.execute("DELETE FROM runs")
    connection.execute("DELETE FROM chunks")
    digests = []
    numbered = [(run[0] - index, place, run) for index, (run, place) in enumerate(zip(runs, places, strict=True))]
    for (_, place), group in groupby(numbered, lambda one: one[:2]):
        consecutive = [run for *_, run in group]
        digests.append(insert_chunk(connection, consecutive, seconds * len(consecutive) / len(runs), place))
    write_meta(connection, content, digests)


def place_of(connection: sqlite3.Connection, versions: Mapping[str, str]) -> int:
    """Returns the place of versions among those that a store names, after adding them if they are new."""
    query = "SELECT name, value FROM meta"
    named = named_versions(dict(connection.execute(f"{query} WHERE name IN ('versions', 'other_versions')").fetchall()))
    if versions in named:
        return named.index(versions)
    meta = dict(connection.execute(query).fetchall())
    changed = {**meta, "other_versions": json.dumps([*named[1:], versions])}
    connection.execute("INSERT OR REPLACE INTO meta VALUES ('other_versions', ?)", (changed["other_versions"],))
    add_digests(connection, [study_digest(meta), study_digest(changed)])
    return len(named)


def upgrade(connection: sqlite3.Connection, contents: Contents) -> None:
    """Turns a store of an earlier version into one of the present, inside a transaction; claims are withdrawn."""
    connection.execute("DROP TABLE chunks")
    connection.execute(_CHUNKS)
    replace_runs(connection, contents.runs, contents.places, contents.seconds, about_itself(contents))


def about_itself(contents: Contents) -> dict[str, str]:
    """Returns what a store says about itself, as :func:`write_meta` takes it."""
    kept = {name: text for name, text in contents.meta.items() if name not in ("format", "version", "digest")}
    return {**kept, "study": contents.description.text}


def add_digests(connection: sqlite3.Connection, chunks: Sequence[int]) -> None:
    """Adds the digests of new chunks to that of the store."""
    before = connection.execute("SELECT value FROM meta WHERE name = 'digest'").fetchone()[0]
    after = to_text(combined(int(before, 16), chunks))
    connection.execute("UPDATE meta SET value = ? WHERE name = 'digest'", (after,))

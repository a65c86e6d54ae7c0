"""The SQLite file format of a store: its tables, reading with checks of version and content, and writing."""

import json
import logging
import math
import sqlite3
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from qtab.sweeps.connection import StoreError, damaged, name_of, reading
from qtab.sweeps.environments import check_environments
from qtab.sweeps.run_records import (
    SUMMARY_COLUMNS,
    StoredRun,
    check_run,
    chunk_digest,
    combined,
    study_digest,
    to_text,
)
from qtab.sweeps.run_versions import UNKNOWN, check_places, named_versions, versions_note, versions_of_runs
from qtab.sweeps.study import StoredStudy, study_from_json

FORMAT = "qtab sweep"
FORMAT_VERSION = 3
"""The version that is written. Version 2, which lacks the software versions of single runs, can also be read, and is
upgraded when its sweep resumes."""

_META = "CREATE TABLE meta (name TEXT PRIMARY KEY, value TEXT NOT NULL)"
_RUNS = (
    f"CREATE TABLE runs ( run INTEGER PRIMARY KEY, seed TEXT NOT NULL, "
    f"{', '.join(f'{name} REAL' for name in SUMMARY_COLUMNS)}, curve BLOB NOT NULL, error TEXT )"
)
_CHUNKS = (
    "CREATE TABLE chunks (start INTEGER PRIMARY KEY, stop INTEGER NOT NULL, owner TEXT, heartbeat REAL, seconds REAL, "
    "digest TEXT, versions INTEGER, CONSTRAINT needs_newer_qtab CHECK (digest IS NULL OR versions IS NOT NULL))"
)
"""The runs ``start`` to ``stop`` - 1. With a digest they are stored; without, ``owner`` claimed them at the time
``heartbeat``. ``versions`` is the place of their software versions among those that the store names.

The constraint rejects results of an earlier qtab that opened the file before another process upgraded it: that process
does not notice that added seeds have renumbered the runs."""
_CHUNKS_2 = (
    "CREATE TABLE chunks (start INTEGER PRIMARY KEY, stop INTEGER NOT NULL, owner TEXT, heartbeat REAL, seconds REAL, "
    "digest TEXT)"
)
_TABLES = {"2": {_META, _CHUNKS_2, _RUNS}, "3": {_META, _CHUNKS, _RUNS}}
_RUN_COLUMNS = f"run, seed, {', '.join(SUMMARY_COLUMNS)}, curve, error"

_LOGGER = logging.getLogger("qtab")


@dataclass(frozen=True)
class Contents:
    """The checked contents of a store."""

    meta: dict[str, str]
    study: StoredStudy
    runs: list[StoredRun]
    seconds: float
    """The total time of the chunks, in seconds, summed over the workers."""
    places: Sequence[int]
    """For each run, the place of its software versions in :func:`qtab.sweeps.run_versions.named_versions`;
    ``UNKNOWN`` if an earlier version did not store them."""


def is_empty(connection: sqlite3.Connection) -> bool:
    """Returns whether the file has no tables."""
    return not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]


def create_tables(connection: sqlite3.Connection, study: StoredStudy, versions: Mapping[str, str]) -> None:
    """Creates the tables for a study in a transaction, with the versions of the process that creates the store."""
    for statement in sorted(_TABLES[str(FORMAT_VERSION)]):
        connection.execute(statement)
    content = {"study": study.text, "versions": json.dumps(versions)}
    if study.environments is not None:
        content["environments"] = study.environments
    write_meta(connection, content, [])


def write_meta(connection: sqlite3.Connection, content: dict[str, str], chunks: Sequence[int]) -> None:
    """Writes the metadata of a store, with the digest of the metadata and of the chunks."""
    meta = {**content, "format": FORMAT, "version": str(FORMAT_VERSION)}
    meta["digest"] = to_text(combined(study_digest(meta), chunks))
    connection.execute("DELETE FROM meta")
    connection.executemany("INSERT INTO meta VALUES (?, ?)", meta.items())


def read_meta(connection: sqlite3.Connection, path: Path | None) -> dict[str, str]:
    """Returns the metadata of a store, after checking its format, its version and its tables.

    Raises:
        StoreError: if the file is not a store, has another format version, or has other tables, views or triggers.
    """
    schema = connection.execute("SELECT type, sql FROM sqlite_master").fetchall()
    # The index that SQLite creates for a primary key has no SQL text.
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
    """Returns the contents of a store, after checking all of them.

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
        study = study_from_json(meta["study"])
        for run in runs:
            if not 0 <= run[0] < study.runs:
                raise ValueError(f"it has a run {run[0]}, but its study has {study.runs} runs")
            setting, position = divmod(run[0], len(study.seeds))
            try:
                check_run(run, study.configs[setting], study.seeds[position], study.block)
            except ValueError as reason:
                raise ValueError(f"run {run[0]}: {reason}") from None
        seconds, places = _check_chunks(connection, meta, study, runs)
        return Contents(meta, study, runs, seconds, places)
    except (ValueError, TypeError) as error:
        raise damaged(path, error) from error


def read_store(path: Path) -> Contents:
    """Returns the contents of a store without writing to it; its sweep may still be running.

    Raises:
        OSError: if the file cannot be read.
        StoreError: if the file is not a store, is damaged, or is empty.
    """
    with reading(path) as connection:
        connection.execute("BEGIN")
        if is_empty(connection):
            raise StoreError(f"{name_of(path)} is empty: its sweep ended before storing anything; start it again")
        contents = read_contents(connection, path)
    if note := versions_note(versions_of_runs(contents.meta, contents.places)):
        _LOGGER.warning("%s: %s", name_of(path), note)
    return contents


def _check_chunks(
    connection: sqlite3.Connection, meta: dict[str, str], study: StoredStudy, runs: list[StoredRun]
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
        if not (type(start) is int and type(stop) is int and after <= start < stop <= study.runs):
            raise ValueError(f"its chunk of runs {start!r} to {stop!r} overlaps another or is not in its study")
        after = stop
        if digest is None:
            continue
        chunk = runs[position : position + stop - start]
        position += len(chunk)
        if [run[0] for run in chunk] != list(range(start, stop)):
            raise ValueError(f"runs are missing among {start} to {stop - 1}, which are marked as finished")
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
    """Returns the stored ones of consecutive runs, without checking them."""
    query = f"SELECT {_RUN_COLUMNS} FROM runs WHERE run >= ? AND run < ?"  # noqa: S608 - fixed names
    return connection.execute(query, (runs.start, runs.stop)).fetchall()


def insert_chunk(connection: sqlite3.Connection, rows: Sequence[StoredRun], seconds: float, place: int) -> int:
    """Stores consecutive runs with their time and the place of their versions; returns their digest."""
    placeholders = ", ".join("?" * (len(SUMMARY_COLUMNS) + 4))
    connection.executemany(f"INSERT INTO runs VALUES ({placeholders})", rows)  # noqa: S608 - placeholders only
    start, stop = rows[0][0], rows[-1][0] + 1
    digest = chunk_digest(start, stop, seconds, rows, place)
    connection.execute(
        "INSERT INTO chunks (start, stop, seconds, digest, versions) VALUES (?, ?, ?, ?, ?)",
        (start, stop, seconds, to_text(digest), place),
    )
    return digest


def is_outdated(contents: Contents, study: StoredStudy) -> bool:
    """Returns whether a store has an earlier format, or fewer seeds than its study."""
    return contents.meta["version"] != str(FORMAT_VERSION) or contents.study.seeds != study.seeds


def rewrite(connection: sqlite3.Connection, contents: Contents, study: StoredStudy) -> None:
    """Rewrites the contents of a store in a transaction: in the current format, with the seeds of a study.

    Runs are numbered by setting and seed, so additional seeds renumber them. Claims are withdrawn.
    """
    old, new = contents.study.seeds, study.seeds
    positions = {seed: position for position, seed in enumerate(new)}
    numbered = []
    for (run, *row), versions in zip(contents.runs, contents.places, strict=True):
        setting, position = divmod(run, len(old))
        numbered.append((setting * len(new) + positions[old[position]], versions, row))
    numbered.sort(key=lambda one: one[0])
    connection.execute("DELETE FROM runs")
    connection.execute("DROP TABLE chunks")
    connection.execute(_CHUNKS)
    digests = []
    for (_, versions), chunk in groupby(enumerate(numbered), lambda one: (one[1][0] - one[0], one[1][1])):
        rows = [(run, *row) for _, (run, _, row) in chunk]
        digests.append(insert_chunk(connection, rows, contents.seconds * len(rows) / len(numbered), versions))
    write_meta(connection, {**contents.meta, "study": study.text}, digests)
    if new != old:
        connection.execute(f"PRAGMA user_version = {(numbering(connection) + 1) % 2**31}")


def numbering(connection: sqlite3.Connection) -> int:
    """Returns the number of times that the runs of a store were numbered."""
    return int(connection.execute("PRAGMA user_version").fetchone()[0])


def place_of(connection: sqlite3.Connection, versions: Mapping[str, str]) -> int:
    """Returns the place of versions among those named in a store, after adding them if they are new."""
    query = "SELECT name, value FROM meta"
    named = named_versions(dict(connection.execute(f"{query} WHERE name IN ('versions', 'other_versions')").fetchall()))
    if versions in named:
        return named.index(versions)
    meta = dict(connection.execute(query).fetchall())
    changed = {**meta, "other_versions": json.dumps([*named[1:], versions])}
    connection.execute("INSERT OR REPLACE INTO meta VALUES ('other_versions', ?)", (changed["other_versions"],))
    add_digests(connection, [study_digest(meta), study_digest(changed)])
    return len(named)


def add_digests(connection: sqlite3.Connection, chunks: Sequence[int]) -> None:
    """Adds the digests of new chunks to the digest of the store."""
    before = connection.execute("SELECT value FROM meta WHERE name = 'digest'").fetchone()[0]
    after = to_text(combined(int(before, 16), chunks))
    connection.execute("UPDATE meta SET value = ? WHERE name = 'digest'", (after,))


def check_study(contents: Contents, study: StoredStudy, path: Path | None) -> None:
    """Checks that a store belongs to a study, or to the same one with fewer seeds.

    Raises:
        StoreError: if it does not.
    """
    if contents.study.text == study.text or study.has_more_seeds(contents.study):
        if study.environments is not None:
            check_environments(contents.meta.get("environments"), study.environments, path)
        return
    if contents.study.has_more_seeds(study):
        raise StoreError(
            f"{name_of(path)} has runs of {len(contents.study.seeds)} seeds, of which this sweep has only "
            f"{len(study.seeds)}; give this sweep all of them, or choose another file"
        )
    raise StoreError(
        f"{name_of(path)} belongs to another sweep (other settings, seeds or environment); choose another file"
    )

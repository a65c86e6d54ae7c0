"""The SQLite file format of a store: its tables, the check of its version, and how runs are read and written."""

import sqlite3
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

FORMAT = "qtab sweep"
FORMAT_VERSION = 1
SUMMARY_COLUMNS = ("episodes", "steps", "mean_return", "final_return", "best_return", "terminated_rate")
BUSY_TIMEOUT_SECONDS = 60.0
"""How long to wait for another process that is writing to the file."""

_SCHEMA = f"""
CREATE TABLE meta (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE pieces (
    piece INTEGER PRIMARY KEY, owner TEXT, heartbeat REAL, done INTEGER NOT NULL DEFAULT 0
);
CREATE TABLE runs (
    run INTEGER PRIMARY KEY, seed TEXT NOT NULL, {", ".join(f"{name} REAL" for name in SUMMARY_COLUMNS)},
    curve BLOB NOT NULL, error TEXT
);
"""
"""A piece is what the code calls a chunk: runs that are trained and stored together."""

StoredRun: TypeAlias = tuple[Any, ...]
"""The index of a run, its summary columns (None if it failed), its learning curve and its error."""


class StoreError(ValueError):
    """A file that is not a store, or not a store that this sweep can use; the message says why."""


@dataclass(frozen=True)
class RunRecord:
    """A run to be stored: its summary and learning curve, or the error with which it failed."""

    seed: int
    summary: dict[str, float | int] | None
    """A value for each of ``SUMMARY_COLUMNS``; None if the run failed."""
    curve: bytes
    """(blocks,) float64: the mean return of each whole block of episodes."""
    error: str | None = None


def connect(path: Path | None) -> sqlite3.Connection:
    """Opens a store for writing; None opens one in memory.

    Raises:
        OSError: if the file cannot be opened or written.
        StoreError: if it is damaged, or not an SQLite file.
    """
    try:
        connection = sqlite3.connect(
            path or ":memory:", timeout=BUSY_TIMEOUT_SECONDS, isolation_level=None, check_same_thread=False
        )
        if path is not None:
            # With these settings a committed transaction survives the end of the process. A power failure can undo the
            # last transactions, but does not damage the file.
            _enable_write_ahead_log(connection)
            connection.execute("PRAGMA synchronous = NORMAL")
    except sqlite3.OperationalError as error:
        raise OSError(f"{name_of(path)}: {error}") from error
    except sqlite3.DatabaseError as error:
        raise damaged(path, error) from error
    return connection


def name_of(path: Path | None) -> str:
    """Returns what messages call a store."""
    return "the store in memory" if path is None else f"store {str(path)!r}"


def damaged(path: Path | None, error: Exception) -> StoreError:
    """Returns the error for a file that SQLite cannot read."""
    return StoreError(f"{name_of(path)} is damaged, or not a sweep store: {error}")


def is_empty(connection: sqlite3.Connection) -> bool:
    """Returns whether the file has no tables."""
    return not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]


def create_tables(connection: sqlite3.Connection, fingerprint: str, chunks: Iterable[int]) -> None:
    """Creates the tables for a study with the given chunk numbers."""
    for statement in filter(str.strip, _SCHEMA.split(";")):
        connection.execute(statement)
    meta = {"format": FORMAT, "version": str(FORMAT_VERSION), "study": fingerprint}
    connection.executemany("INSERT INTO meta VALUES (?, ?)", meta.items())
    connection.executemany("INSERT INTO pieces (piece) VALUES (?)", ((chunk,) for chunk in chunks))


def read_fingerprint(connection: sqlite3.Connection, path: Path | None) -> str:
    """Returns the fingerprint of the study, after checking the format of the store.

    Raises:
        StoreError: if the file is not a store, or has another format version.
    """
    try:
        meta = dict(connection.execute("SELECT name, value FROM meta").fetchall())
    except sqlite3.OperationalError:
        meta = {}
    if meta.get("format") != FORMAT or "study" not in meta:
        raise StoreError(f"{name_of(path)} is not a sweep store")
    if meta.get("version") != str(FORMAT_VERSION):
        raise StoreError(
            f"{name_of(path)} has format version {meta.get('version')!r}, but this qtab reads {FORMAT_VERSION}"
        )
    return str(meta["study"])


def read_runs(connection: sqlite3.Connection) -> list[StoredRun]:
    """Returns the stored runs, ordered by their index."""
    return connection.execute(
        f"SELECT run, {', '.join(SUMMARY_COLUMNS)}, curve, error FROM runs ORDER BY run"  # noqa: S608 - fixed names
    ).fetchall()


def insert_runs(connection: sqlite3.Connection, runs: range, records: Sequence[RunRecord]) -> None:
    """Stores the records of the runs with these indices."""
    rows = []
    for run, record in zip(runs, records, strict=True):
        summary = record.summary
        values = [None] * len(SUMMARY_COLUMNS) if summary is None else [summary[name] for name in SUMMARY_COLUMNS]
        rows.append((run, str(record.seed), *values, record.curve, record.error))
    placeholders = ", ".join("?" * (len(SUMMARY_COLUMNS) + 4))
    connection.executemany(f"INSERT INTO runs VALUES ({placeholders})", rows)  # noqa: S608 - placeholders only


def _enable_write_ahead_log(connection: sqlite3.Connection) -> None:
    # SQLite's timeout does not apply if two processes switch at the same time: one of them fails at once.
    deadline = time.monotonic() + BUSY_TIMEOUT_SECONDS
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            return
        except sqlite3.OperationalError as error:
            if "locked" not in str(error) or time.monotonic() > deadline:
                raise
        time.sleep(0.01)

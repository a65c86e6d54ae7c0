"""A sweep's store: one SQLite file, in which pieces are claimed and results entered once."""

import os
import socket
import sqlite3
import threading
import time
import uuid
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from qtab.sweeps.study import Piece, Study
from qtab.sweeps.worker import Row

FORMAT = "qtab sweep"
FORMAT_VERSION = 1
HEARTBEAT = 5.0
"""Seconds between two signs of life."""
EXPIRY = 60.0
"""Seconds of silence after which a claim is another's to take."""
COLUMNS = ("episodes", "steps", "mean_return", "final_return", "best_return", "terminated_rate")

_SCHEMA = f"""
CREATE TABLE meta (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE pieces (
    piece INTEGER PRIMARY KEY, owner TEXT, heartbeat REAL, done INTEGER NOT NULL DEFAULT 0
);
CREATE TABLE runs (
    run INTEGER PRIMARY KEY, seed TEXT NOT NULL, {", ".join(f"{name} REAL" for name in COLUMNS)},
    curve BLOB NOT NULL, error TEXT
);
"""


class StoreError(ValueError):
    """A store that cannot serve this sweep; it says why."""


class Store:
    """The store of one sweep, as one process sees it."""

    def __init__(self, path: "str | os.PathLike[str] | None", study: Study) -> None:
        """Opens a store, or begins one; None keeps it in memory.

        Raises:
            OSError: if the file cannot be opened or written.
            StoreError: if it is damaged, of another version, or of another sweep.
        """
        self._path = None if path is None else Path(path)
        self._owner = f"{socket.gethostname()}/{os.getpid()}/{uuid.uuid4().hex}"
        self._silent = threading.Event()
        self._connection = _connect(self._path)
        try:
            with self._errors():
                self._open(study)
        except BaseException:
            self._connection.close()
            raise
        self._pulse = threading.Thread(target=self._beat, daemon=True)
        if self._path is not None:
            self._pulse.start()

    def close(self) -> None:
        """Lets go of what was claimed and not finished."""
        self._silent.set()
        if self._pulse.is_alive():
            self._pulse.join()
        with closing(self._connection), self._errors(), self._transaction():
            self._connection.execute(
                "UPDATE pieces SET owner = NULL, heartbeat = NULL WHERE owner = ? AND NOT done", (self._owner,)
            )

    def claim(self) -> int | None:
        """Returns the number of a piece that nobody works on, now this process's; None where there is none."""
        with self._errors(), self._transaction():
            now = time.time()
            found = self._connection.execute(
                "SELECT piece FROM pieces WHERE NOT done AND (owner IS NULL OR heartbeat < ?) ORDER BY piece LIMIT 1",
                (now - EXPIRY,),
            ).fetchone()
            if found is None:
                return None
            self._connection.execute(
                "UPDATE pieces SET owner = ?, heartbeat = ? WHERE piece = ?", (self._owner, now, found[0])
            )
            return int(found[0])

    def enter(self, piece: Piece, rows: Sequence[Row]) -> bool:
        """Stores a piece's results in one transaction; returns False if another process was faster."""
        marks = ", ".join("?" * (len(COLUMNS) + 4))
        values = []
        for run, row in zip(range(piece.start, piece.stop), rows, strict=True):
            summary = [None] * len(COLUMNS) if row.summary is None else [row.summary[name] for name in COLUMNS]
            values.append((run, str(row.seed), *summary, row.curve, row.error))
        with self._errors(), self._transaction():
            changed = self._connection.execute(
                "UPDATE pieces SET done = 1, owner = NULL, heartbeat = NULL WHERE piece = ? AND NOT done",
                (piece.number,),
            ).rowcount
            if changed:
                self._connection.executemany(f"INSERT INTO runs VALUES ({marks})", values)  # noqa: S608 - marks alone
            return bool(changed)

    def finished(self) -> tuple[int, int]:
        """Returns how many pieces, and how many runs, are done."""
        with self._errors():
            pieces = self._connection.execute("SELECT count(*) FROM pieces WHERE done").fetchone()[0]
            return int(pieces), int(self._connection.execute("SELECT count(*) FROM runs").fetchone()[0])

    def rows(self) -> list[tuple[Any, ...]]:
        """Returns what is stored: run, summary columns, curve and error, in the order of the runs."""
        with self._errors():
            return self._connection.execute(
                f"SELECT run, {', '.join(COLUMNS)}, curve, error FROM runs ORDER BY run"  # noqa: S608 - fixed names
            ).fetchall()

    def _open(self, study: Study) -> None:
        with self._transaction():
            if not self._connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
                for statement in filter(str.strip, _SCHEMA.split(";")):
                    self._connection.execute(statement)
                meta = {"format": FORMAT, "version": str(FORMAT_VERSION), "study": study.identity}
                self._connection.executemany("INSERT INTO meta VALUES (?, ?)", meta.items())
                numbers = ((piece.number,) for piece in study.pieces)
                self._connection.executemany("INSERT INTO pieces (piece) VALUES (?)", numbers)
                return
            try:
                meta = dict(self._connection.execute("SELECT name, value FROM meta").fetchall())
            except sqlite3.OperationalError:
                meta = {}
            if meta.get("format") != FORMAT:
                raise StoreError(f"{self._name} is no store of a sweep")
            if meta.get("version") != str(FORMAT_VERSION):
                raise StoreError(
                    f"{self._name} has version {meta.get('version')!r} of the format, this qtab has {FORMAT_VERSION}"
                )
            if meta.get("study") != study.identity:
                raise StoreError(
                    f"{self._name} belongs to another sweep (other settings, seeds or environment); name another file"
                )
            self._release_the_dead()
        # A file cut short shows up here, not in the middle of the work.
        if self._connection.execute("PRAGMA quick_check").fetchone()[0] != "ok":
            raise StoreError(f"{self._name} is damaged")

    def _release_the_dead(self) -> None:
        """Processes of this machine that are no more keep nobody waiting."""
        owners = self._connection.execute("SELECT DISTINCT owner FROM pieces WHERE owner IS NOT NULL").fetchall()
        for (owner,) in owners:
            host, pid, _ = owner.split("/")
            if host == socket.gethostname() and not _alive(int(pid)):
                self._connection.execute("UPDATE pieces SET owner = NULL, heartbeat = NULL WHERE owner = ?", (owner,))

    def _beat(self) -> None:
        connection = _connect(self._path)
        with closing(connection):
            while not self._silent.wait(HEARTBEAT):
                try:
                    connection.execute(
                        "UPDATE pieces SET heartbeat = ? WHERE owner = ? AND NOT done", (time.time(), self._owner)
                    )
                except sqlite3.OperationalError:
                    continue  # busy, or a full disk: the next piece to be entered says so

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        self._connection.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            if self._connection.in_transaction:
                self._connection.execute("ROLLBACK")
            raise
        self._connection.execute("COMMIT")

    @contextmanager
    def _errors(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.OperationalError as error:
            raise OSError(f"{self._name}: {error}") from error
        except sqlite3.DatabaseError as error:
            raise StoreError(f"{self._name} is damaged or no store: {error}") from error

    @property
    def _name(self) -> str:
        return "the store" if self._path is None else f"store {str(self._path)!r}"


def _connect(path: Path | None) -> sqlite3.Connection:
    try:
        connection = sqlite3.connect(path or ":memory:", timeout=EXPIRY, isolation_level=None, check_same_thread=False)
        if path is not None:
            # Killed at any moment, it holds what was committed; only a power cut may take the last pieces back.
            _write_ahead(connection)
            connection.execute("PRAGMA synchronous = NORMAL")
    except sqlite3.OperationalError as error:
        raise OSError(f"store {str(path)!r}: {error}") from error
    except sqlite3.DatabaseError as error:
        raise StoreError(f"store {str(path)!r} is damaged or no store: {error}") from error
    return connection


def _alive(pid: int) -> bool:
    if os.name != "posix":
        return True  # there is no harmless way to ask; the claim expires
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return True


def _write_ahead(connection: sqlite3.Connection) -> None:
    """Switches a file to the write-ahead log: where two do so at once, SQLite gives up on one without waiting."""
    deadline = time.monotonic() + EXPIRY
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            return
        except sqlite3.OperationalError as error:
            if "locked" not in str(error) or time.monotonic() > deadline:
                raise
        time.sleep(0.01)

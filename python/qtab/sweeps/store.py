"""The store of a sweep: processes claim chunks of runs in it and commit the results, each chunk once."""

import os
import socket
import sqlite3
import threading
import time
import uuid
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path

from qtab.sweeps.database import (
    RunRecord,
    StoredRun,
    StoreError,
    connect,
    create_tables,
    damaged,
    insert_runs,
    is_empty,
    name_of,
    read_fingerprint,
    read_runs,
)
from qtab.sweeps.study import Chunk, Study

HEARTBEAT_SECONDS = 5.0
"""The time between two heartbeats of a process, which keep its claims valid."""
CLAIM_EXPIRY_SECONDS = 60.0
"""A claim without a heartbeat for this long can be taken over by another process."""


class Store:
    """The connection of one process to the store of a study."""

    def __init__(self, path: "str | os.PathLike[str] | None", study: Study) -> None:
        """Opens a store, or creates it; None keeps it in memory.

        Raises:
            OSError: if the file cannot be opened or written.
            StoreError: if it is damaged, has another format version, or belongs to another study.
        """
        self._path = None if path is None else Path(path)
        self._owner = f"{socket.gethostname()}/{os.getpid()}/{uuid.uuid4().hex}"
        self._closing = threading.Event()
        self._connection = connect(self._path)
        try:
            with self._translated_errors():
                self._open(study)
        except BaseException:
            self._connection.close()
            raise
        self._heartbeat_thread = threading.Thread(target=self._send_heartbeats, daemon=True)
        if self._path is not None:
            self._heartbeat_thread.start()

    def close(self) -> None:
        """Releases the unfinished claims of this process and closes the file."""
        self._closing.set()
        if self._heartbeat_thread.is_alive():
            self._heartbeat_thread.join()
        with closing(self._connection), self._translated_errors(), self._transaction():
            self._connection.execute(
                "UPDATE pieces SET owner = NULL, heartbeat = NULL WHERE owner = ? AND NOT done", (self._owner,)
            )

    def claim(self) -> int | None:
        """Claims an unfinished chunk for this process and returns its number; None if all are claimed or done."""
        with self._translated_errors(), self._transaction():
            now = time.time()
            row = self._connection.execute(
                "SELECT piece FROM pieces WHERE NOT done AND (owner IS NULL OR heartbeat < ?) ORDER BY piece LIMIT 1",
                (now - CLAIM_EXPIRY_SECONDS,),
            ).fetchone()
            if row is None:
                return None
            self._connection.execute(
                "UPDATE pieces SET owner = ?, heartbeat = ? WHERE piece = ?", (self._owner, now, row[0])
            )
            return int(row[0])

    def commit(self, chunk: Chunk, records: Sequence[RunRecord]) -> bool:
        """Stores the results of a chunk in one transaction; returns False if another process has already done so."""
        with self._translated_errors(), self._transaction():
            is_first = self._connection.execute(
                "UPDATE pieces SET done = 1, owner = NULL, heartbeat = NULL WHERE piece = ? AND NOT done",
                (chunk.number,),
            ).rowcount
            if is_first:
                insert_runs(self._connection, chunk.runs, records)
            return bool(is_first)

    def finished(self) -> tuple[int, int]:
        """Returns the number of finished chunks and the number of finished runs."""
        with self._translated_errors():
            chunks = self._connection.execute("SELECT count(*) FROM pieces WHERE done").fetchone()[0]
            return int(chunks), int(self._connection.execute("SELECT count(*) FROM runs").fetchone()[0])

    def runs(self) -> list[StoredRun]:
        """Returns the finished runs, ordered by their index."""
        with self._translated_errors():
            return read_runs(self._connection)

    def _open(self, study: Study) -> None:
        with self._transaction():
            if is_empty(self._connection):
                create_tables(self._connection, study.fingerprint, (chunk.number for chunk in study.chunks))
                return
            if read_fingerprint(self._connection, self._path) != study.fingerprint:
                raise StoreError(
                    f"{name_of(self._path)} belongs to another sweep (other settings, seeds or environment); choose "
                    "another file"
                )
            self._release_claims_of_ended_processes()
        # Finds a truncated file now instead of during training.
        if self._connection.execute("PRAGMA quick_check").fetchone()[0] != "ok":
            raise StoreError(f"{name_of(self._path)} is damaged")

    def _release_claims_of_ended_processes(self) -> None:
        """Releases at once the claims of processes of this machine that no longer run."""
        owners = self._connection.execute("SELECT DISTINCT owner FROM pieces WHERE owner IS NOT NULL").fetchall()
        for (owner,) in owners:
            host, pid, _ = owner.split("/")
            if host == socket.gethostname() and not _is_running(int(pid)):
                self._connection.execute("UPDATE pieces SET owner = NULL, heartbeat = NULL WHERE owner = ?", (owner,))

    def _send_heartbeats(self) -> None:
        connection = connect(self._path)
        with closing(connection):
            while not self._closing.wait(HEARTBEAT_SECONDS):
                try:
                    connection.execute(
                        "UPDATE pieces SET heartbeat = ? WHERE owner = ? AND NOT done", (time.time(), self._owner)
                    )
                except sqlite3.OperationalError:
                    continue  # busy, or the disk is full: the next commit reports it

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
    def _translated_errors(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.OperationalError as error:
            raise OSError(f"{name_of(self._path)}: {error}") from error
        except sqlite3.DatabaseError as error:
            raise damaged(self._path, error) from error


def _is_running(pid: int) -> bool:
    if os.name != "posix":
        return True  # elsewhere os.kill(pid, 0) would end the process; the claim expires instead
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    return True

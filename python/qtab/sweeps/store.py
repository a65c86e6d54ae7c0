"""The store of a sweep: processes claim runs in it and commit the results, each run once."""

import json
import os
import sqlite3
import stat
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from qtab._utils.versions import versions
from qtab.sweeps import claims, version_1
from qtab.sweeps.connection import (
    StoreError,
    bounded,
    check_header,
    connect,
    name_of,
    translated_errors,
    when_unlocked,
)
from qtab.sweeps.database import Contents, RunRecord, create_tables, insert_runs, is_empty, read_contents, read_meta
from qtab.sweeps.description import Description
from qtab.sweeps.digests import chunk_digest, combined, to_text
from qtab.sweeps.stored import check_study, store_path, warn_unchecked


class Store:
    """The connection of one process to the store of a study."""

    def __init__(self, path: "str | os.PathLike[str] | None", description: Description) -> None:
        """Opens a store, or creates it; None keeps it in memory.

        Raises:
            OSError: if the file cannot be opened or written.
            StoreError: if it is damaged, has another format version, or belongs to another study.
            TypeError: if ``path`` is not a path.
            ValueError: if ``path`` names no file.
        """
        self.path = None if path is None else store_path(path)
        """The file; None if the store is in memory."""
        self._description = description
        self._owner = claims.new_owner()
        self._claim_watch = claims.ClaimWatch()
        self._done_until = 0
        self._closing = threading.Event()
        with translated_errors(self.path):
            self._connection = connect(self.path)
        try:
            with translated_errors(self.path):
                self._open()
        except BaseException:
            self._connection.close()
            raise
        self._file = None if self.path is None else _identity(self.path)
        self._heartbeat_thread = threading.Thread(target=self._send_heartbeats, daemon=True)
        if self.path is not None:
            self._heartbeat_thread.start()

    def close(self) -> None:
        """Releases the unfinished claims of this process and closes the file."""
        self._closing.set()
        if self._heartbeat_thread.is_alive():
            self._heartbeat_thread.join()
        # A claim that cannot be released is lost when this process ends, or expires.
        with closing(self._connection), suppress(OSError, StoreError), self._transaction():
            self._connection.execute("DELETE FROM chunks WHERE owner = ? AND digest IS NULL", (self._owner,))

    def claim(self, size: Callable[[int], int]) -> range | None:
        """Claims runs that are neither finished nor claimed, for this process; None if there are none.

        Args:
            size: Returns how many runs to claim, from the index of the first one.
        """
        with self._transaction():
            free = self._first_gap()
            if free is None:
                self._release_lost_claims()
                free = self._first_gap()
            if free is None:
                return None
            claimed = range(free.start, min(free.stop, free.start + size(free.start)))
            self._connection.execute(
                "INSERT INTO chunks (start, stop, owner, heartbeat) VALUES (?, ?, ?, ?)",
                (claimed.start, claimed.stop, self._owner, time.time()),
            )
            return claimed

    def commit(self, claim: range, records: Sequence[RunRecord], seconds: float) -> bool:
        """Stores the results of the first runs of a claim in one transaction, and releases the others.

        Args:
            claim: What :meth:`claim` returned.
            records: The results of its first runs, or of all of them.
            seconds: The time that they took.

        Returns:
            False if another process has taken over the claim; nothing is stored then.
        """
        stop = claim.start + len(records)
        rows = [record.as_row(run) for run, record in zip(claim, records, strict=False)]
        with self._transaction():
            digest = chunk_digest(claim.start, stop, seconds, rows)
            is_mine = self._connection.execute(
                "UPDATE chunks SET stop = ?, seconds = ?, digest = ?, owner = NULL, heartbeat = NULL "
                "WHERE start = ? AND stop = ? AND owner = ? AND digest IS NULL",
                (stop, seconds, to_text(digest), claim.start, claim.stop, self._owner),
            ).rowcount
            if is_mine:
                insert_runs(self._connection, rows)
                before = self._connection.execute("SELECT value FROM meta WHERE name = 'digest'").fetchone()[0]
                after = to_text(combined(int(before, 16), [digest]))
                self._connection.execute("UPDATE meta SET value = ? WHERE name = 'digest'", (after,))
            return bool(is_mine)

    def release(self, claim: range) -> None:
        """Releases a claim, so that its runs can be claimed again."""
        with self._transaction():
            self._connection.execute(
                "DELETE FROM chunks WHERE start = ? AND owner = ? AND digest IS NULL", (claim.start, self._owner)
            )

    def finished(self) -> int:
        """Returns the number of finished runs."""
        with translated_errors(self.path):
            query = "SELECT coalesce(sum(stop - start), 0) FROM chunks WHERE digest IS NOT NULL"
            return int(self._connection.execute(query).fetchone()[0])

    def claimed_by_others(self) -> str:
        """Returns which runs other processes are training, for messages."""
        with translated_errors(self.path):
            query = "SELECT owner, sum(stop - start) FROM chunks WHERE digest IS NULL GROUP BY owner"
            rows = self._connection.execute(query).fetchall()
        owners = ", ".join(f"{runs} by {claims.describe(owner)}" for owner, runs in rows)
        return f"runs of {name_of(self.path)} that are being trained: {owners or 'none'}"

    def contents(self) -> Contents:
        """Returns all that is stored, after checking it."""
        with translated_errors(self.path), self._reading():
            return read_contents(self._connection, self.path)

    def _open(self) -> None:
        path = self.path
        if path is not None:
            check_header(path)
            with bounded(self._connection, path):
                if not is_empty(self._connection):
                    read_meta(self._connection, path)
            # With these settings a committed transaction survives the end of the process. A power failure can undo the
            # last transactions, but does not damage the file.
            when_unlocked(self._connection, "PRAGMA journal_mode = WAL", path)
            self._connection.execute("PRAGMA synchronous = NORMAL")
        with self._transaction(), bounded(self._connection, path):
            if is_empty(self._connection):
                create_tables(self._connection, self._description, json.dumps(versions()))
                return
            if read_meta(self._connection, path)["version"] == "1":
                contents = read_contents(self._connection, path)
                check_study(contents, self._description, path)
                version_1.check_chunks(self._connection, path, contents)
                version_1.upgrade(self._connection, contents)
        with bounded(self._connection, path):
            contents = self.contents()  # finds damage now instead of after the training
        check_study(contents, self._description, path)
        warn_unchecked(contents, path)

    def _first_gap(self) -> range | None:
        """Returns the first runs that are neither finished nor claimed; None if there are none."""
        free = self._done_until
        chunks = self._connection.execute(
            "SELECT start, stop, digest IS NOT NULL FROM chunks WHERE start >= ? ORDER BY start", (free,)
        )
        for start, stop, done in chunks.fetchall():
            if start > free:
                return range(free, start)
            free = stop
            if done and start == self._done_until:
                self._done_until = stop
        return range(free, self._description.runs) if free < self._description.runs else None

    def _release_lost_claims(self) -> None:
        rows = self._connection.execute("SELECT start, stop, owner, heartbeat FROM chunks WHERE digest IS NULL")
        for start, stop, owner, heartbeat in rows.fetchall():
            if owner != self._owner and self._claim_watch.is_lost(start, stop, owner, heartbeat):
                self._connection.execute("DELETE FROM chunks WHERE start = ? AND digest IS NULL", (start,))

    def _send_heartbeats(self) -> None:
        with suppress(sqlite3.Error), closing(connect(self.path, "rw")) as connection:
            while not self._closing.wait(claims.HEARTBEAT_SECONDS):
                with suppress(sqlite3.OperationalError):  # busy, or the disk is full: the next commit reports it
                    connection.execute(
                        "UPDATE chunks SET heartbeat = ? WHERE owner = ? AND digest IS NULL", (time.time(), self._owner)
                    )

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        with translated_errors(self.path):
            self._check_file()
            when_unlocked(self._connection, "BEGIN IMMEDIATE", self.path)
            try:
                yield
            except BaseException:
                if self._connection.in_transaction:
                    self._connection.execute("ROLLBACK")
                raise
            self._connection.execute("COMMIT")

    @contextmanager
    def _reading(self) -> Iterator[None]:
        """A transaction that sees one state of the file."""
        self._connection.execute("BEGIN")
        try:
            yield
        finally:
            self._connection.execute("ROLLBACK")

    def _check_file(self) -> None:
        """Raises an error if the file is no longer at its path: what is written to it would be lost."""
        file = getattr(self, "_file", None)
        if self.path is not None and file is not None and _identity(self.path) != file:
            raise FileNotFoundError(f"{name_of(self.path)} was deleted or replaced during the sweep")


def _identity(path: Path) -> tuple[int, int] | None:
    """Returns what tells a file from every other; None if it does not exist."""
    try:
        status = path.stat()
    except OSError:
        return None
    return (status.st_dev, status.st_ino) if stat.S_ISREG(status.st_mode) else None

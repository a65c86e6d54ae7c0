"""The store of a sweep: processes claim runs in it and store the results, each run once.

A run has the same results in every process. So it does not matter which process trains it, and none has to find out
whether another is still alive: a process that finds no other runs also trains runs that others have claimed, and the
first result is stored.
"""

import logging
import os
import stat
import time
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from qtab._utils.versions import versions as versions_here
from qtab.sweeps.connection import (
    StoreError,
    bounded,
    check_header,
    connect,
    is_writable,
    name_of,
    store_path,
    translated_errors,
    when_unlocked,
)
from qtab.sweeps.run_records import RunRecord
from qtab.sweeps.run_versions import other_versions
from qtab.sweeps.store_format import (
    Contents,
    add_digests,
    check_study,
    create_tables,
    insert_chunk,
    is_empty,
    is_outdated,
    numbering,
    place_of,
    read_contents,
    read_meta,
    read_runs,
    read_store,
    rewrite,
)
from qtab.sweeps.study import StoredStudy

_LOGGER = logging.getLogger("qtab")


class Store:
    """The connection of one process to the store of a study."""

    def __init__(self, path: "str | os.PathLike[str] | None", study: StoredStudy) -> None:
        """Opens or creates a store; None keeps it in memory.

        Raises:
            OSError: if the file cannot be opened or written.
            StoreError: if the file is damaged, has another format version, or belongs to another study.
            TypeError: if ``path`` is not a path.
            ValueError: if ``path`` is empty.
        """
        self.path = None if path is None else store_path(path)
        """The file; None if the store is in memory."""
        self._study = study
        self._owner = uuid.uuid4().hex
        self._claims: list[range] = []
        """The claims of this process that are neither committed nor released."""
        self._done_until = 0
        """All runs before this one are stored. Searching the chunks of a day would take a fifth of a second."""
        self._file: tuple[int, int] | None = None
        self._numbering: int | None = None
        with translated_errors(self.path):
            self._connection = connect(self.path)
        try:
            with translated_errors(self.path):
                self._open()
        except BaseException:
            self._connection.close()
            raise
        self._file = None if self.path is None else _identity(self.path)

    def close(self) -> None:
        """Withdraws the claims of this process and closes the file."""
        # If a claim cannot be withdrawn, other processes only train its runs last.
        with closing(self._connection), suppress(OSError, StoreError), self._transaction():
            self._connection.execute("DELETE FROM chunks WHERE owner = ? AND digest IS NULL", (self._owner,))

    def claim(self, size: Callable[[int], int]) -> range | None:
        """Claims runs for this process to train; returns None if it has claimed all that are not stored.

        Unclaimed runs come first, then the oldest claims of other processes.

        Args:
            size: Returns the number of runs to claim, given the index of the first one.
        """
        with self._transaction():
            free = self._first_unclaimed() or self._first_of_others()
            if free is None:
                return None
            claimed = range(free.start, min(free.stop, free.start + size(free.start)))
            self._connection.execute(
                "INSERT INTO chunks (start, stop, owner, heartbeat) VALUES (?, ?, ?, ?)",
                (claimed.start, claimed.stop, self._owner, time.time()),
            )
        self._claims.append(claimed)
        return claimed

    def commit(
        self, claim: range, records: Sequence[RunRecord], seconds: float, versions: Mapping[str, str] | None = None
    ) -> None:
        """Stores the results of the first runs of a claim in one transaction, and releases the others.

        Runs that another process has stored in the meantime are not replaced. If their results differ, this is logged.

        Args:
            claim: The result of :meth:`claim`.
            records: The results of its first runs, or of all of them.
            seconds: The time that the runs took.
            versions: The versions of the process that trained them; None means those of this process.
        """
        trained = range(claim.start, claim.start + len(records))
        rows = [record.as_row(run) for run, record in zip(trained, records, strict=True)]
        bounds = trained.stop, trained.start
        with self._transaction():
            self._withdraw(claim)
            self._connection.execute("DELETE FROM chunks WHERE digest IS NULL AND start < ? AND stop > ?", bounds)
            stored = self._ranges("start < ? AND stop > ?", *bounds)
            digests = []
            for part in _gaps(trained, stored):
                place = place_of(self._connection, versions or versions_here())
                of_part = rows[part.start - trained.start : part.stop - trained.start]
                digests.append(insert_chunk(self._connection, of_part, seconds * len(part) / len(trained), place))
            add_digests(self._connection, digests)
            others = {run[0]: run for part in stored for run in read_runs(self._connection, part)}
        different = [row[0] for row in rows if row[0] in others and others[row[0]] != row]
        if different:
            _LOGGER.warning(
                "the results of %d of %d runs trained here differ from those in %s, which are kept: the environment "
                "does not repeat itself, or the processes use different code",
                len(different),
                len(rows),
                name_of(self.path),
            )

    def release(self, claim: range) -> None:
        """Withdraws a claim."""
        with self._transaction():
            self._withdraw(claim)

    def finished(self) -> int:
        """Returns the number of finished runs."""
        with translated_errors(self.path):
            query = "SELECT coalesce(sum(stop - start), 0) FROM chunks WHERE digest IS NOT NULL"
            return int(self._connection.execute(query).fetchone()[0])

    def contents(self) -> Contents:
        """Returns the contents of the store, after checking them."""
        with self._transaction(writes=False):
            return read_contents(self._connection, self.path)

    def _open(self) -> None:
        path, study = self.path, self._study
        if path is not None:
            check_header(path)
            with bounded(self._connection, path):
                if not is_empty(self._connection):
                    read_meta(self._connection, path)  # check that it is a store before writing to it
            # With these settings a committed transaction survives the end of the process. A power failure can undo the
            # last transactions, but does not damage the file.
            when_unlocked(self._connection, "PRAGMA journal_mode = WAL", path)
            self._connection.execute("PRAGMA synchronous = NORMAL")
        with self._transaction(), bounded(self._connection, path):
            if is_empty(self._connection):
                create_tables(self._connection, study, versions_here())
        # Read everything, to find damage now instead of after the training.
        with self._transaction(writes=False), bounded(self._connection, path):
            number, contents = numbering(self._connection), read_contents(self._connection, path)
        check_study(contents, study, path)
        if study.environments is not None:
            _warn_of_differences(contents, path)
        if is_outdated(contents, study):
            with self._transaction(), bounded(self._connection, path):
                contents = read_contents(self._connection, path)  # another process may have changed it since
                check_study(contents, study, path)
                if is_outdated(contents, study):
                    rewrite(self._connection, contents, study)
                number = numbering(self._connection)
        self._numbering = number

    def _first_unclaimed(self) -> range | None:
        """Returns the first runs that are neither stored nor claimed; None if there are none."""
        chunks = self._connection.execute(
            "SELECT start, stop, digest IS NOT NULL FROM chunks WHERE start >= ? ORDER BY start", (self._done_until,)
        ).fetchall()
        for start, stop, is_stored in chunks:
            if not is_stored or start > self._done_until:
                break
            self._done_until = stop
        taken = [*(range(start, stop) for start, stop, _ in chunks), *self._claims]
        return next(_gaps(range(self._done_until, self._study.runs), taken), None)

    def _first_of_others(self) -> range | None:
        """Withdraws the oldest claim of another process, and returns its runs; None if there are none."""
        for claim in self._ranges("digest IS NULL AND owner IS NOT ? ORDER BY heartbeat, start", self._owner):
            free = next(_gaps(claim, self._claims), None)
            if free is not None:
                self._connection.execute("DELETE FROM chunks WHERE start = ?", (claim.start,))
                return free
        return None

    def _withdraw(self, claim: range) -> None:
        self._claims.remove(claim)
        self._connection.execute(
            "DELETE FROM chunks WHERE start = ? AND owner = ? AND digest IS NULL", (claim.start, self._owner)
        )

    def _ranges(self, condition: str, *values: object) -> list[range]:
        """Returns the runs of the chunks that satisfy a condition."""
        rows = self._connection.execute(f"SELECT start, stop FROM chunks WHERE {condition}", values)  # noqa: S608 - ours
        return [range(start, stop) for start, stop in rows.fetchall()]

    @contextmanager
    def _transaction(self, writes: bool = True) -> Iterator[None]:
        """Runs the context in a transaction, which sees a single state of the file."""
        with translated_errors(self.path):
            if writes:
                self._check_file()
            when_unlocked(self._connection, "BEGIN IMMEDIATE" if writes else "BEGIN", self.path)
            try:
                self._check_numbering()
                yield
            except BaseException:
                if self._connection.in_transaction:
                    self._connection.execute("ROLLBACK")
                raise
            self._connection.execute("COMMIT")

    def _check_numbering(self) -> None:
        """Raises an error if another process has added seeds to the store, which renumbers its runs."""
        if self._numbering is not None and numbering(self._connection) != self._numbering:
            raise StoreError(
                f"{name_of(self.path)} was given more seeds by another process; give this sweep the same seeds"
            )

    def _check_file(self) -> None:
        """Raises an error if the file is no longer at its path: further results would be lost."""
        if self.path is not None and self._file is not None and _identity(self.path) != self._file:
            raise FileNotFoundError(f"{name_of(self.path)} was deleted or replaced during the sweep")


def finished_contents(path: Path, study: StoredStudy) -> Contents | None:
    """Returns the contents of a finished read-only store; None if the store is writable or does not exist.

    Raises:
        OSError: if the store is not finished.
        StoreError: if the file is damaged, or belongs to another study.
    """
    if not path.exists() or is_writable(path):
        return None
    contents = read_store(path)
    check_study(contents, study, path)
    _warn_of_differences(contents, path)
    if len(contents.runs) < study.runs:
        raise PermissionError(
            f"{name_of(path)} cannot be written, and has only {len(contents.runs):,} of {study.runs:,} runs"
        )
    return contents


def _warn_of_differences(contents: Contents, path: Path | None) -> None:
    """Logs the information that a store lacks, and the versions of its results if they differ from these."""
    if "environments" not in contents.meta:
        _LOGGER.warning(
            "%s stores only the id and the arguments of its environment, like all stores of earlier versions: the "
            "rest of the environment is not compared",
            name_of(path),
        )
    if contents.runs and (others := other_versions(contents.meta, contents.places)):
        _LOGGER.warning("%s has results made with %s; new results may differ", name_of(path), ", ".join(others))


def _gaps(runs: range, taken: Iterable[range]) -> Iterator[range]:
    """Yields the parts of ``runs`` that are in none of the ranges ``taken``."""
    free = runs.start
    for other in sorted(taken, key=lambda one: one.start):
        if free < min(other.start, runs.stop):
            yield range(free, min(other.start, runs.stop))
        free = max(free, other.stop)
    if free < runs.stop:
        yield range(free, runs.stop)


def _identity(path: Path) -> tuple[int, int] | None:
    """Returns numbers that identify a file; None if it does not exist."""
    with suppress(OSError):
        status = path.stat()
        return (status.st_dev, status.st_ino) if stat.S_ISREG(status.st_mode) else None
    return None

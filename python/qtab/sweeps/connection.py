"""Connections to SQLite files that are not trusted, as https://www.sqlite.org/security.html advises."""

import logging
import os
import shutil
import sqlite3
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

HEADER_BYTES = 100
MAGIC = b"SQLite format 3\0"
LOCK_TIMEOUT_SECONDS = 2.0
"""The time that SQLite waits for another process that is writing, before the wait is logged."""
BUSY_TIMEOUT_SECONDS = 60.0
"""The total time to wait for another process that is writing."""
OPERATIONS_PER_BYTE = 100
"""The maximum number of SQLite's virtual machine instructions per byte of a file, for reading it."""
MIN_OPERATIONS = 20_000_000
"""The instructions allowed for reading a small file: about a second."""
OPERATIONS_BETWEEN_CHECKS = 100_000

_LIMITS = {
    "SQLITE_LIMIT_SQL_LENGTH": 100_000,
    "SQLITE_LIMIT_COLUMN": 100,
    "SQLITE_LIMIT_EXPR_DEPTH": 10,
    "SQLITE_LIMIT_COMPOUND_SELECT": 3,
    "SQLITE_LIMIT_VDBE_OP": 25_000,
    "SQLITE_LIMIT_FUNCTION_ARG": 8,
    "SQLITE_LIMIT_ATTACHED": 0,
    "SQLITE_LIMIT_LIKE_PATTERN_LENGTH": 50,
    "SQLITE_LIMIT_VARIABLE_NUMBER": 20,
    "SQLITE_LIMIT_TRIGGER_DEPTH": 1,
}
"""The limits that this package's statements stay within; SQLite's documentation recommends setting them."""

_OPTIONS = {
    "SQLITE_DBCONFIG_DEFENSIVE": True,
    "SQLITE_DBCONFIG_ENABLE_TRIGGER": False,
    "SQLITE_DBCONFIG_ENABLE_VIEW": False,
}
_ENVIRONMENT = ("locked", "is full", "readonly", "unable to open", "disk I/O", "out of memory", "access permission")
"""Parts of the messages of SQLite errors that are caused by the machine, not by the content of the file.

Python 3.10 has no error codes.
"""

_LOGGER = logging.getLogger("qtab")


class StoreError(ValueError):
    """Raised for a file that is not a store, or not a store that this sweep can use; the message gives the reason."""


def store_path(path: Any) -> Path:
    """Returns the argument ``store`` as a path.

    Raises:
        OSError: if ``path`` exists and is not a regular file.
        TypeError: if ``path`` is not a path.
        ValueError: if ``path`` is empty.
    """
    if not isinstance(path, str | os.PathLike):
        raise TypeError(f"store must be a path or None, got {path!r}")
    text = os.fspath(path)
    if not isinstance(text, str):
        raise TypeError(f"store must be a path or None, got {path!r}")
    if text in ("", ":memory:") or text.startswith("file:") or "\0" in text:
        raise ValueError(f"store must be the path of a file, got {text!r}; None keeps the results in memory")
    found = Path(text)
    if found.is_dir():
        raise IsADirectoryError(f"store must be a file, got the folder {text!r}")
    if found.exists() and not found.is_file():
        raise OSError(f"store must be a regular file, got {text!r}")
    return found


def name_of(path: Path | None) -> str:
    """Returns the name of a store in messages."""
    return "the store in memory" if path is None else f"store {str(path)!r}"


def damaged(path: Path | None, reason: object) -> StoreError:
    """Returns the error for a file that cannot be read as a store."""
    return StoreError(f"{name_of(path)} is damaged, or not a sweep store: {' '.join(str(reason).split())}")


@contextmanager
def translated_errors(path: Path | None) -> Iterator[None]:
    """Turns SQLite errors into an OSError if the machine is the cause, and into a StoreError otherwise."""
    try:
        yield
    except (sqlite3.Error, sqlite3.Warning, UnicodeError, OverflowError) as error:
        if isinstance(error, sqlite3.OperationalError) and any(part in str(error) for part in _ENVIRONMENT):
            raise OSError(f"{name_of(path)}: {error}") from error
        raise damaged(path, error) from error


def connect(path: Path | None, mode: str = "rwc", **parameters: str) -> sqlite3.Connection:
    """Opens a file; None opens a database in memory.

    Args:
        path: The file.
        mode: ``"rwc"`` creates the file if it does not exist, ``"rw"`` does not, ``"ro"`` opens it read-only.
        **parameters: Additional parameters of SQLite's URIs.

    Raises:
        sqlite3.Error: if the file cannot be opened.
    """
    query = "&".join(f"{name}={value}" for name, value in {"mode": mode, **parameters}.items())
    name = ":memory:" if path is None else f"{path.absolute().as_uri()}?{query}"
    connection = sqlite3.connect(
        name, timeout=LOCK_TIMEOUT_SECONDS, isolation_level=None, check_same_thread=False, uri=path is not None
    )
    try:
        connection.execute("PRAGMA trusted_schema = OFF")
        connection.execute("PRAGMA cell_size_check = ON")
        connection.execute("PRAGMA mmap_size = 0")
        if hasattr(connection, "setlimit"):  # from Python 3.11
            for limit, most in _LIMITS.items():
                connection.setlimit(getattr(sqlite3, limit), most)
        if hasattr(connection, "setconfig"):  # from Python 3.12
            for option, value in _OPTIONS.items():
                connection.setconfig(getattr(sqlite3, option), value)
    except BaseException:
        connection.close()
        raise
    return connection


@contextmanager
def bounded(connection: sqlite3.Connection, path: Path | None) -> Iterator[None]:
    """Bounds the work of the queries inside the context, in proportion to the size of the file.

    Raises:
        sqlite3.OperationalError: if a query exceeds the bound.
    """
    size = 0 if path is None else path.stat().st_size + _log_size(path)
    left = (MIN_OPERATIONS + OPERATIONS_PER_BYTE * size) // OPERATIONS_BETWEEN_CHECKS

    def is_too_much() -> bool:
        nonlocal left
        left -= 1
        return left < 0

    handler: Callable[[], Any] = is_too_much
    connection.set_progress_handler(handler, OPERATIONS_BETWEEN_CHECKS)
    try:
        yield
    finally:
        connection.set_progress_handler(None, 0)


def check_header(path: Path) -> None:
    """Checks the first bytes of a nonempty file.

    SQLite would open a file whose header names a newer format, but read-only.

    Raises:
        OSError: if the file cannot be read.
        StoreError: if the file is not an SQLite file.
    """
    with path.open("rb") as file:
        header = file.read(HEADER_BYTES)
    if header and (len(header) < HEADER_BYTES or not header.startswith(MAGIC)):
        raise damaged(path, "it is not an SQLite file")
    if header and not (header[18] in (1, 2) and header[19] in (1, 2)):
        raise damaged(path, "its header names an unknown format of SQLite")


@contextmanager
def reading(path: Path) -> Iterator[sqlite3.Connection]:
    """Yields a read-only connection; the file may be on a read-only medium.

    Raises:
        OSError: if the file cannot be opened.
        StoreError: if the file is not an SQLite file.
    """
    check_header(path)
    with ExitStack() as on_exit, translated_errors(path):
        connection = _open_for_reading(path, on_exit)
        on_exit.callback(connection.close)
        connection.execute("PRAGMA query_only = ON")
        with bounded(connection, path):
            yield connection


def is_writable(path: Path) -> bool:
    """Returns whether this process may write to a file, and create files beside it."""
    effective = os.access in os.supports_effective_ids
    return all(os.access(place, os.W_OK, effective_ids=effective) for place in (path, path.parent))


def _open_for_reading(path: Path, on_exit: ExitStack) -> sqlite3.Connection:
    try:
        return _readable(connect(path, "rw"))
    except sqlite3.OperationalError:
        if is_writable(path):
            raise
    # A write-ahead log needs a file beside the store, which cannot be created here.
    if not _log_size(path):
        return _readable(connect(path, "ro", immutable="1"))
    folder = Path(on_exit.enter_context(tempfile.TemporaryDirectory()))
    copy = folder / path.name
    shutil.copyfile(path, copy)
    shutil.copyfile(_log(path), _log(copy))
    return _readable(connect(copy, "rw"))


def _readable(connection: sqlite3.Connection) -> sqlite3.Connection:
    try:
        connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
    except BaseException:
        connection.close()
        raise
    return connection


def _log(path: Path) -> Path:
    """Returns the path of the write-ahead log of a file."""
    return path.with_name(f"{path.name}-wal")


def _log_size(path: Path) -> int:
    log = _log(path)
    return log.stat().st_size if log.is_file() else 0


def when_unlocked(connection: sqlite3.Connection, statement: str, path: Path | None) -> None:
    """Executes a statement as soon as no other process is writing to the file; logs a long wait.

    SQLite's timeout does not apply if two processes switch to a write-ahead log at the same time: one of them fails
    at once.

    Raises:
        sqlite3.Error: if the file is still locked after ``BUSY_TIMEOUT_SECONDS``.
    """
    began, was_logged = time.monotonic(), False
    while True:
        try:
            connection.execute(statement)
            return
        except sqlite3.OperationalError as error:
            waited = time.monotonic() - began
            if "locked" not in str(error) or waited > BUSY_TIMEOUT_SECONDS:
                raise
        if waited > LOCK_TIMEOUT_SECONDS and not was_logged:
            was_logged = True
            _LOGGER.warning("waiting for another process that is writing to %s", name_of(path))
        time.sleep(0.01)

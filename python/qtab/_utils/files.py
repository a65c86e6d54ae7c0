"""Writes files completely or not at all, even if the process is killed or the machine loses power."""

import errno
import os
import re
import secrets
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

_LOCKS_BY_OPENING = os.name == "nt"
"""Whether an open file can be neither removed nor renamed, as on Windows, so that opening it serves as a lock."""
_KINDS = {stat.S_IFIFO: "FIFO", stat.S_IFSOCK: "socket", stat.S_IFCHR: "device", stat.S_IFBLK: "device"}
_MAX_STEM, _MAX_SUFFIX = 30, 20
"""The maximum number of characters of a name to repeat in its temporary name: file systems allow 255 bytes."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yields a temporary path with the same suffix in the same folder, which replaces ``path`` if no error occurs.

    If ``path`` is a symbolic link, its target is replaced. The new file has the permissions of the old one, or else
    those of the umask. Temporary files that killed processes left for the same path are removed.

    Args:
        path: The file to write.

    Raises:
        OSError: if the file cannot be written, or if ``path`` exists and is not a regular file.
    """
    target = check_writable("path", path)
    with _temporary_file(target) as (temporary, lock):
        yield temporary
        with temporary.open("rb+") as written:
            os.fsync(written.fileno())
        with suppress(FileNotFoundError):
            temporary.chmod(stat.S_IMODE(target.stat().st_mode))
        if _LOCKS_BY_OPENING:
            lock.close()
        temporary.replace(target)
        _sync_folder(target.parent)


def check_writable(name: str, path: Path) -> Path:
    """Checks that a file can be written to a path, and returns the path without symbolic links.

    Args:
        name: The name of the argument, for the message.
        path: The path.

    Raises:
        OSError: if it cannot, or if ``path`` exists and is not a regular file; the message gives the reason.
    """
    try:
        _check_regular(name, path)
        target = path.resolve()
        with tempfile.TemporaryFile(dir=target.parent):
            pass
    except RuntimeError:  # symbolic links in a circle, up to Python 3.12
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path)) from None
    except OSError as error:
        if error.strerror is None:
            raise
        raise type(error)(f"{name} must be a file that can be written, got {str(path)!r}: {error.strerror}") from None
    return target


def _check_regular(name: str, path: Path) -> None:
    try:
        kind = stat.S_IFMT(path.stat().st_mode)
    except FileNotFoundError:
        return
    if kind == stat.S_IFDIR:
        raise IsADirectoryError(f"{name} must be a file, got the folder {str(path)!r}")
    if kind != stat.S_IFREG:
        raise OSError(f"{name} must be a regular file, got the {_KINDS.get(kind, 'special file')} {str(path)!r}")


@contextmanager
def _temporary_file(target: Path) -> Iterator[tuple[Path, BinaryIO]]:
    """Yields the path of a new file beside the target, and its lock; removes the file afterwards if it still exists.

    The file is locked while it is in use. A killed process leaves the file but not its lock, so that the next process
    can detect an abandoned file.
    """
    suffix = target.suffix if len(target.suffix) <= _MAX_SUFFIX else ""
    before, after = f".{target.stem[:_MAX_STEM]}-", f".tmp{suffix}"
    _remove_abandoned(target.parent, re.compile(re.escape(before) + "[0-9a-f]{16}" + re.escape(after)))
    lock = None
    while lock is None:
        temporary = target.with_name(f"{before}{secrets.token_hex(8)}{after}")
        lock = _create_locked(temporary)
    try:
        yield temporary, lock
    finally:
        if _LOCKS_BY_OPENING:
            lock.close()
        temporary.unlink(missing_ok=True)
        lock.close()


def _create_locked(temporary: Path) -> BinaryIO | None:
    """Creates and locks a file; returns it open, or None if it was removed before it was locked."""
    file = temporary.open("xb+")
    if not _LOCKS_BY_OPENING:
        with suppress(OSError):  # a file system without locks, where no file counts as abandoned
            if not _lock(file.fileno()) or not temporary.exists():
                file.close()
                return None
    return file


def _remove_abandoned(folder: Path, name: "re.Pattern[str]") -> None:
    """Removes the temporary files whose name matches and that no process has locked."""
    with suppress(OSError), os.scandir(folder) as entries:
        found = [Path(entry.path) for entry in entries if name.fullmatch(entry.name)]
        for temporary in found:
            with suppress(OSError):  # another process may have removed it or, on Windows, may have it open
                if _LOCKS_BY_OPENING:
                    temporary.unlink()
                    continue
                handle = os.open(temporary, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0))
                try:
                    if _lock(handle):
                        temporary.unlink()
                finally:
                    os.close(handle)


def _lock(handle: int) -> bool:
    """Locks a file until it is closed or the process ends; returns False if another process has locked it.

    Raises:
        OSError: if its file system has no locks.
    """
    if fcntl is None:
        raise OSError(errno.ENOTSUP, os.strerror(errno.ENOTSUP))
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _sync_folder(folder: Path) -> None:
    """Flushes a folder to disk, so that a new name in it survives a power failure."""
    if _LOCKS_BY_OPENING:
        return  # folders cannot be opened on Windows
    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):  # some file systems do not support it
            os.fsync(handle)
    finally:
        os.close(handle)

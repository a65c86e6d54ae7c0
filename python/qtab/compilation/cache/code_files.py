"""Files of compiled code: beside the user's file, or in the user's cache folder."""

import base64
import contextlib
import hashlib
import json
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from qtab.compilation.cache.machine_code import MachineCode

_MAGIC = b"qtab compiled environment 1\n"


def read(source_file: str, digest: str) -> tuple[MachineCode | None, dict[str, Any]] | None:
    """Returns the stored code and its description; None if there is no file, or it is damaged.

    The code is None if the environment was found not to be compilable; the description contains the reason.

    Args:
        source_file: The user's file.
        digest: The digest of everything that the code depends on.
    """
    for folder in _folders(source_file):
        try:
            content = _content(folder / _name(digest))
        except OSError:
            continue
        if (found := _parse(content)) is not None:
            return found
    return None


def write(source_file: str, digest: str, code: MachineCode | None, description: dict[str, Any]) -> Path | None:
    """Stores code and its description, in the first folder that can be written.

    A temporary file is written and renamed, so that other processes see all of it or nothing.

    Args:
        source_file: The user's file.
        digest: The digest of everything that the code depends on.
        code: The code; None if the environment cannot be compiled.
        description: Values of JSON that describe it.

    Returns:
        The path of the file; None if no folder can be written.
    """
    header = dict(description)
    if code is not None:
        header |= {"object_file": base64.b64encode(code.object_file).decode(), "needed": list(code.needed)}
    body = json.dumps(header).encode()
    content = _MAGIC + hashlib.sha256(body).hexdigest().encode() + b"\n" + body
    for folder in _folders(source_file):
        with contextlib.suppress(OSError):
            private = folder.name != "__pycache__"  # the user's cache
            folder.mkdir(0o700 if private else 0o777, parents=True, exist_ok=True)
            if private and sys.platform != "win32" and folder.stat().st_uid == os.geteuid():
                folder.chmod(0o700)
            _require_own(folder.stat())
            handle, temporary = tempfile.mkstemp(dir=folder, prefix=".qtab-")
            try:
                with os.fdopen(handle, "wb") as file:
                    file.write(content)
                Path(temporary).replace(folder / _name(digest))
            except OSError:
                Path(temporary).unlink(missing_ok=True)
                raise
            return folder / _name(digest)
    return None


def _content(path: Path) -> bytes:
    """Returns the bytes of a file that nobody else can have written.

    Raises:
        OSError: if there is no such file, or other users than this one and the administrator can write it.
    """
    if sys.platform == "win32":
        return path.read_bytes()
    _require_own(path.parent.stat())
    with os.fdopen(os.open(path, os.O_RDONLY | os.O_NOFOLLOW), "rb") as file:
        _require_own(os.fstat(file.fileno()))
        return file.read()


def _require_own(status: os.stat_result) -> None:
    if sys.platform != "win32" and (status.st_uid not in (os.geteuid(), 0) or status.st_mode & 0o022):
        raise PermissionError("other users can write it")


def _parse(content: bytes) -> tuple[MachineCode | None, dict[str, Any]] | None:
    if not content.startswith(_MAGIC):
        return None
    checksum, _, body = content[len(_MAGIC) :].partition(b"\n")
    if hashlib.sha256(body).hexdigest().encode() != checksum:
        return None
    description: dict[str, Any] = json.loads(body)
    if "object_file" not in description:
        return None, description
    code = MachineCode(base64.b64decode(description.pop("object_file")), tuple(description.pop("needed")))
    return code, description


def _name(digest: str) -> str:
    return f"qtab-{digest}.{'proofs' if digest.endswith('-proofs') else 'compiled'}"


def _folders(source_file: str) -> Iterator[Path]:
    """Yields the folders for the code of a file: as for Python's byte code, and then the user's cache."""
    path = Path(source_file)
    if path.is_file():
        yield path.parent / "__pycache__"
    with contextlib.suppress(RuntimeError):  # the user has no home
        yield _cache() / "qtab" / "compiled"


def _cache() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")

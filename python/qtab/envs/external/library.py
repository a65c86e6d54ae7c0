"""Loading of shared libraries that export an environment."""

import ctypes
import hashlib
import os
import shutil
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from qtab import _core
from qtab.envs.external.trial import capsule_in, check_for_crash, try_out

_lock = threading.Lock()
_loaded: dict[str, "Library"] = {}
"""The libraries loaded by this process, by the digest of their content."""
_in_place: dict[str, str] = {}
"""The digests of the libraries of which no copy could be loaded, by their paths."""


@dataclass(frozen=True)
class Library:
    """A shared library that was loaded and tried out. It stays loaded until the process ends."""

    digest: str
    """A digest of its content."""
    capsule: Any
    """The capsule of its environment."""
    external: _core.ExternalEnv
    """The environment."""


def load(path: "str | os.PathLike[str]") -> Library:
    """Loads a shared library; one with the same content is loaded only once.

    A copy is loaded, so that the file may be compiled again while this process runs: a library that changes while it is
    in use would end the process, and the system would not load it again from the same path.

    Args:
        path: The path of the library.

    Raises:
        FileNotFoundError: if there is no such file.
        OSError: if it cannot be read.
        ValueError: if it is not a library for this machine, exports no environment, or one that crashes or breaks a
            rule of ``qtab_env.h`` in some random steps.
    """
    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"path must be that of a shared library, but there is no file {str(file)!r}")
    content = file.read_bytes()
    digest = hashlib.sha256(content).hexdigest()[:32]
    with _lock:
        if digest not in _loaded:
            _loaded[digest] = _load(file, content, digest)
        return _loaded[digest]


def load_again(path: str, digest: str) -> Library:
    """Loads the library that had a digest, perhaps in another process.

    Args:
        path: Its path.
        digest: The digest of its content.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it was compiled again since.
    """
    library = _loaded.get(digest) or load(path)
    if library.digest != digest:
        raise ValueError(f"{path} was compiled again since the environment was copied or pickled")
    return library


def _load(file: Path, content: bytes, digest: str) -> Library:
    try:
        check_for_crash(_core.__file__, file.resolve())
        capsule = capsule_in(_load_copy(file.resolve(), content, digest))
        return Library(digest, capsule, try_out(_core, capsule))
    except ValueError as error:
        raise ValueError(f"{file} cannot be used: {error}") from None


def _load_copy(file: Path, content: bytes, digest: str) -> ctypes.CDLL:
    folder = Path(tempfile.mkdtemp(prefix="qtab-"))
    try:
        copy = folder / file.name
        copy.write_bytes(content)
        return ctypes.CDLL(str(copy))
    except OSError:
        pass  # it may need other files beside it, or the temporary folder does not allow code
    finally:
        shutil.rmtree(folder, ignore_errors=True)  # Windows keeps the file until the process ends
    if _in_place.get(str(file), digest) != digest:
        # The system would return the functions that are loaded already.
        raise ValueError("it was compiled again, and this process still has its earlier version: start Python again")
    try:
        library = ctypes.CDLL(str(file))
    except OSError as error:
        raise ValueError(f"it must be a shared library that this machine can load: {error}") from None
    _in_place[str(file)] = digest
    return library

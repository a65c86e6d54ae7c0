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

SYMBOL = "qtab_env_1"
_NAME = b"qtab.env.1"
"""The name of the capsules, which refer to these bytes."""
_TRIAL_STEPS = 100
_TRIAL_SEED = 0

_lock = threading.Lock()
_loaded: dict[str, "Library"] = {}
"""The libraries loaded by this process, by the digest of their content."""


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
        ValueError: if it is not a library for this machine, exports no environment, or one that breaks a rule of
            ``qtab_env.h`` in some random steps.
    """
    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"path must be that of a shared library, but there is no file {str(file)!r}")
    digest = hashlib.sha256(file.read_bytes()).hexdigest()[:32]
    with _lock:
        if digest not in _loaded:
            _loaded[digest] = _load(file, digest)
        return _loaded[digest]


def _load(file: Path, digest: str) -> Library:
    library = _load_copy(file)
    try:
        function = getattr(library, SYMBOL)
    except AttributeError:
        raise ValueError(f"{file} must export the function {SYMBOL}() of qtab_env.h, but has none") from None
    function.argtypes, function.restype = [], ctypes.c_void_p
    address = function()
    if not address:
        raise ValueError(f"{file} cannot be used: {SYMBOL}() returned NULL")
    new_capsule = ctypes.pythonapi.PyCapsule_New
    new_capsule.argtypes, new_capsule.restype = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p], ctypes.py_object
    capsule = new_capsule(address, _NAME, None)
    try:
        external = _core.ExternalEnv(capsule)
        external.try_out(_TRIAL_STEPS, _TRIAL_SEED)
    except ValueError as error:
        raise ValueError(f"{file} cannot be used: {error}") from None
    return Library(digest, capsule, external)


def _load_copy(file: Path) -> ctypes.CDLL:
    folder = tempfile.mkdtemp(prefix="qtab-")
    try:
        copy = shutil.copy(file, folder)
        return ctypes.CDLL(copy)
    except OSError:
        pass  # it may need other files beside it, or the temporary folder does not allow code
    finally:
        shutil.rmtree(folder, ignore_errors=True)  # Windows keeps the file until the process ends
    try:
        return ctypes.CDLL(str(file.resolve()))
    except OSError as error:
        raise ValueError(f"{file} must be a shared library that this machine can load: {error}") from None

"""A trial of a shared library, in this process or in a separate one, which a library that crashes then ends instead.

As a program (``trial.py extension library``) it imports nothing of this package, so that it takes a tenth of a second.
"""

import ctypes
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

SYMBOL = "qtab_env_1"
_NAME = b"qtab.env.1"
"""The name of the capsules, which refer to these bytes."""
_STEPS = 100
_SEED = 0
_SECONDS = 60.0
"""The most time of a trial in a separate process."""


def capsule_in(library: ctypes.CDLL) -> Any:
    """Returns the capsule of the environment that a library exports.

    Raises:
        ValueError: if it exports none.
    """
    try:
        function = getattr(library, SYMBOL)
    except AttributeError:
        raise ValueError(f"it must export the function {SYMBOL}() of qtab_env.h, but has none") from None
    function.argtypes, function.restype = [], ctypes.c_void_p
    address = function()
    if not address:
        raise ValueError(f"{SYMBOL}() returned NULL")
    new_capsule = ctypes.pythonapi.PyCapsule_New
    new_capsule.argtypes, new_capsule.restype = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p], ctypes.py_object
    return new_capsule(address, _NAME, None)


def try_out(core: Any, capsule: Any) -> Any:
    """Checks the environment of a capsule and some random steps in it, and returns it as ``core.ExternalEnv``.

    Args:
        core: The module ``qtab._core``.
        capsule: The capsule.

    Raises:
        ValueError: for a rule of ``qtab_env.h`` that it breaks.
    """
    external = core.ExternalEnv(capsule)
    external.try_out(_STEPS, _SEED)
    return external


def check_for_crash(extension: str, file: Path) -> None:
    """Tries a library out in a separate process, if one can be started.

    Args:
        extension: The path of the extension module.
        file: The path of the library.

    Raises:
        ValueError: if the process crashes, or takes longer than a minute.
    """
    if not Path(sys.executable or "").name.startswith("python"):
        return  # in a program that embeds Python
    command = [sys.executable, "-I", __file__, extension, str(file)]
    try:
        done = subprocess.run(command, capture_output=True, timeout=_SECONDS, check=False)  # noqa: S603 - our own program
    except subprocess.TimeoutExpired:
        raise ValueError(f"a trial of {_STEPS} steps did not end within {_SECONDS:.0f} seconds") from None
    except OSError:
        return
    if done.returncode < 0:
        raise ValueError(f"it crashed in a trial of {_STEPS} steps ({_signal_name(-done.returncode)})")
    if done.returncode > 255:  # as Windows reports a violation; Python exits with less
        raise ValueError(f"it crashed in a trial of {_STEPS} steps (exit code {done.returncode:#x})")


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _main(extension: str, file: str) -> None:
    from importlib.machinery import ExtensionFileLoader
    from importlib.util import module_from_spec, spec_from_loader

    spec = spec_from_loader("_core", ExtensionFileLoader("_core", extension))
    if spec is None or spec.loader is None:
        return
    core = module_from_spec(spec)
    spec.loader.exec_module(core)
    with suppress(OSError, ValueError):  # which the process that waits for this one reports
        try_out(core, capsule_in(ctypes.CDLL(file)))


if __name__ == "__main__":
    _main(*sys.argv[1:])

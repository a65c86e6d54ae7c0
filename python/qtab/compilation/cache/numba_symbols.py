"""Numba's C functions, without the import of Numba, which takes longer than a short run."""

import sys
from collections.abc import Iterable
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

_MEMORY = "core.runtime._nrt_python"
"""The functions for the memory of arrays, whose names start with ``NRT_``."""
_HELPERS = "_helperlib"
"""Those of the C library, such as ``cos``, by their own names, and Numba's, whose names start with ``numba_``."""

_loaded: dict[str, Any] = {}
"""The extension modules that were loaded here, whose state is made once."""


def provide(llvm: Any, names: Iterable[str]) -> bool:
    """Makes functions known to ``llvmlite.binding`` at the addresses where Numba has them.

    Args:
        llvm: ``llvmlite.binding``.
        names: The names that code needs; those that Numba does not have are left out.

    Returns:
        Whether Numba's functions were found; otherwise its import makes them known.
    """
    needed = set(names)
    is_found = True
    if any(name.startswith("NRT_") for name in needed):
        memory = {name if name.startswith("_") else f"NRT_{name}": at for name, at in _functions(_MEMORY).items()}
        is_found = bool(memory)
        _add(llvm, memory)  # all of them, since they share a state that is made once
        needed -= memory.keys()
    if needed:
        helpers = _functions(_HELPERS)
        is_found = is_found and bool(helpers)
        # As Numba names them: that of the C library is the one that it proved and compiled with.
        _add(
            llvm,
            {name: helpers[name.removeprefix("numba_")] for name in needed if name.removeprefix("numba_") in helpers},
        )
    return is_found


def _add(llvm: Any, functions: dict[str, int]) -> None:
    for name, address in functions.items():
        llvm.add_symbol(name, address)


def _functions(module: str) -> dict[str, int]:
    """Returns the addresses of the functions of one of Numba's extension modules, by name; empty if it is missing."""
    found = getattr(_extension(module), "c_helpers", None)
    return found if isinstance(found, dict) else {}


def _extension(module: str) -> Any:
    """Returns one of Numba's extension modules; None if it is missing or cannot be loaded outside its package."""
    name = f"numba.{module}"
    if (known := sys.modules.get(name) or _loaded.get(name)) is not None:
        return known
    package = find_spec("numba")
    for folder in (package.submodule_search_locations or []) if package is not None else []:
        for suffix in EXTENSION_SUFFIXES:
            path = Path(folder, f"{module.replace('.', '/')}{suffix}")
            spec = spec_from_file_location(name, path, loader=ExtensionFileLoader(name, str(path)))
            if path.is_file() and spec is not None and spec.loader is not None:
                try:
                    made = module_from_spec(spec)
                    spec.loader.exec_module(made)
                except (ImportError, OSError):  # a missing DLL, for example: the whole of Numba is imported then
                    return None
                finally:
                    sys.modules.pop(name, None)  # so that Numba imports it as a part of its package
                _loaded[name] = made
                return made
    return None

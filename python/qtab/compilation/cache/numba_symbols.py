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


def provide(llvm: Any, names: Iterable[str]) -> None:
    """Makes functions known to ``llvmlite.binding`` at the addresses where Numba has them.

    Args:
        llvm: ``llvmlite.binding``.
        names: The names that code needs; those that are not found are left out.
    """
    needed = set(names)
    if any(name.startswith("NRT_") for name in needed):
        memory = {name if name.startswith("_") else f"NRT_{name}": at for name, at in _functions(_MEMORY).items()}
        _add(llvm, memory)  # all of them, since they share a state that is made once
        needed -= memory.keys()
    if needed:
        helpers = _functions(_HELPERS)
        # As Numba names them: that of the C library is the one that it proved and compiled with.
        _add(
            llvm,
            {name: helpers[name.removeprefix("numba_")] for name in needed if name.removeprefix("numba_") in helpers},
        )


def _add(llvm: Any, functions: dict[str, int]) -> None:
    for name, address in functions.items():
        llvm.add_symbol(name, address)


def _functions(module: str) -> dict[str, int]:
    """Returns the addresses of the functions of one of Numba's extension modules, by name; empty if it is missing."""
    found = getattr(_extension(module), "c_helpers", None)
    return found if isinstance(found, dict) else {}


def _extension(module: str) -> Any:
    name = f"numba.{module}"
    if name in sys.modules:
        return sys.modules[name]
    package = find_spec("numba")
    for folder in (package.submodule_search_locations or []) if package is not None else []:
        for suffix in EXTENSION_SUFFIXES:
            path = Path(folder, f"{module.replace('.', '/')}{suffix}")
            spec = spec_from_file_location(name, path, loader=ExtensionFileLoader(name, str(path)))
            if path.is_file() and spec is not None and spec.loader is not None:
                made = module_from_spec(spec)
                spec.loader.exec_module(made)
                sys.modules.pop(name, None)  # so that Numba imports it as a part of its package
                return made
    return None

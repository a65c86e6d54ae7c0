"""Numba's functions for the memory of arrays, without the import of Numba, which takes longer than a short run."""

from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

_NAME = "numba.core.runtime._nrt_python"


def provide_runtime(llvm: Any) -> None:
    """Makes the functions known to ``llvmlite.binding``, if Numba's extension module is where it should be."""
    module = _extension()
    helpers = getattr(module, "c_helpers", None)
    if isinstance(helpers, dict):
        for name, address in helpers.items():
            llvm.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)


def _extension() -> Any:
    package = find_spec("numba")
    for folder in (package.submodule_search_locations or []) if package is not None else []:
        for suffix in EXTENSION_SUFFIXES:
            path = Path(folder, "core", "runtime", f"_nrt_python{suffix}")
            spec = spec_from_file_location(_NAME, path, loader=ExtensionFileLoader(_NAME, str(path)))
            if path.is_file() and spec is not None and spec.loader is not None:
                module = module_from_spec(spec)
                spec.loader.exec_module(module)
                return module
    return None

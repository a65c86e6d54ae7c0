"""Shared libraries for the tests, compiled with the system's compiler and with Cargo."""

import ctypes
import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import qtab
from support.repository import ROOT

SUFFIX = {"darwin": ".dylib", "win32": ".dll"}.get(sys.platform, ".so")
COMPILER = os.environ.get("CC") or shutil.which("cc")
CAPSULE = b"qtab.env.1"
SOURCES = Path(__file__).parent
EXAMPLES = ROOT / "examples"

needs_compiler = pytest.mark.skipif(COMPILER is None or sys.platform == "win32", reason="needs a C compiler")
needs_cargo = pytest.mark.skipif(shutil.which("cargo") is None, reason="needs Cargo")


def compile_c(source: str | Path, folder: Path, name: str = "environment", *options: str) -> Path:
    """Compiles a source file, or a text in C, into a shared library in the folder."""
    file = source
    if isinstance(source, str):
        file = folder / f"{name}.c"
        file.write_text(source, encoding="utf-8")
    library = folder / f"lib{name}{SUFFIX}"
    command = [str(COMPILER), "-O2", "-shared", "-fPIC", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror"]
    subprocess.run([*command, *options, "-I", qtab.get_include(), str(file), "-o", str(library), "-lm"], check=True)
    return library


def example_class(path: str, name: str) -> type[Any]:
    """A class of a file in ``examples``, which is no package."""
    spec = importlib.util.spec_from_file_location(Path(path).stem, EXAMPLES / path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # its environments can be pickled
    spec.loader.exec_module(module)
    found: type[Any] = getattr(module, name)
    return found


def capsule_of(library: Path) -> Any:
    """The capsule of a library's environment, without the trial of ``qtab.NativeEnv``."""
    function = ctypes.CDLL(str(library)).qtab_env_1
    function.argtypes, function.restype = [], ctypes.c_void_p
    new_capsule = ctypes.pythonapi.PyCapsule_New
    new_capsule.argtypes, new_capsule.restype = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p], ctypes.py_object
    return new_capsule(function(), CAPSULE, None)


def build_rust(crate: Path, folder: Path, name: str) -> Path:
    """Builds a crate into a shared library in the folder."""
    command = ["cargo", "build", "--release", "--offline", "--quiet", "--target-dir", str(folder)]
    subprocess.run(command, cwd=crate, check=True)
    prefix = "" if sys.platform == "win32" else "lib"
    return folder / "release" / f"{prefix}{name}{SUFFIX}"

"""The struct in ctypes is that of the header, as a C compiler reads it; capsules keep what they need alive."""

import ctypes
import gc
import shutil
import subprocess
import weakref
from pathlib import Path

import numpy as np
import pytest

from qtab.compilation.interface import qtab_env
from qtab.compilation.interface.pycapsule import NAME, make_capsule
from support.repository import PACKAGE

HEADER = PACKAGE / "include" / "qtab_env.h"
CONSTANTS = {
    "QTAB_ENV_VERSION": qtab_env.VERSION,
    "QTAB_FLOAT32": qtab_env.FLOAT32,
    "QTAB_FLOAT64": qtab_env.FLOAT64,
    "QTAB_INT64": qtab_env.INT64,
    "QTAB_CONTINUES": qtab_env.CONTINUES,
    "QTAB_TERMINATED": qtab_env.TERMINATED,
    "QTAB_TRUNCATED": qtab_env.TRUNCATED,
    "QTAB_FAILED": qtab_env.FAILED,
}


@pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler")
def test_it_equals_the_header(tmp_path: Path) -> None:
    names = [field[0] for field in qtab_env.QtabEnv._fields_]
    lines = [f'printf("%zu %zu\\n", offsetof(qtab_env, {name}), sizeof(((qtab_env *)0)->{name}));' for name in names]
    lines += [f'printf("%d\\n", (int){name});' for name in CONSTANTS]
    lines += ['printf("%zu\\n", sizeof(qtab_env));']
    source = tmp_path / "sizes.c"
    includes = f'#include <stddef.h>\n#include <stdio.h>\n#include "{HEADER}"\n'
    source.write_text(includes + "int main(void) {\n" + "\n".join(lines) + "\nreturn 0;\n}\n")
    subprocess.run(["cc", "-Werror", str(source), "-o", str(tmp_path / "sizes")], check=True)
    printed = subprocess.run([str(tmp_path / "sizes")], check=True, capture_output=True, text=True).stdout.splitlines()
    fields = [getattr(qtab_env.QtabEnv, name) for name in names]
    expected = [f"{field.offset} {field.size}" for field in fields]
    assert printed == [*expected, *map(str, CONSTANTS.values()), str(ctypes.sizeof(qtab_env.QtabEnv))]


def test_a_capsule_keeps_what_it_needs() -> None:
    memory = np.arange(3.0)
    gone = weakref.ref(memory)
    capsule = make_capsule(qtab_env.QtabEnv(version=1, parameters=memory.ctypes.data), memory)
    del memory
    gc.collect()
    pointer = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)(
        ("PyCapsule_GetPointer", ctypes.pythonapi)
    )
    held, kept = qtab_env.QtabEnv.from_address(pointer(capsule, NAME)), gone()
    assert kept is not None
    assert (held.version, held.parameters) == (1, kept.ctypes.data)
    del capsule, held, kept
    gc.collect()
    assert gone() is None

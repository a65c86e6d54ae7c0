"""PyCapsules of ``qtab_env`` structs, which keep the memory and the code of the struct alive."""

import ctypes
from typing import Any

from qtab.compilation.interface.qtab_env import QtabEnv

NAME = b"qtab.env.1"
"""The name of the capsules; PyCapsule stores the address, so it is never freed."""

_Destructor: Any = ctypes.CFUNCTYPE(None, ctypes.c_void_p)
_kept: dict[int, tuple[Any, ...]] = {}
"""What each capsule in use needs, by the address of its struct."""


def _api(name: str, result: Any, *arguments: Any) -> Any:
    function = getattr(ctypes.pythonapi, name)
    prototype = ctypes.PYFUNCTYPE(result, *arguments)
    return prototype(ctypes.cast(function, ctypes.c_void_p).value or 0)


_new = _api("PyCapsule_New", ctypes.py_object, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)
_pointer_of_dying = _api("PyCapsule_GetPointer", ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p)


def _release(capsule: int, kept: dict[int, Any] = _kept, pointer: Any = _pointer_of_dying, name: bytes = NAME) -> None:
    # It runs while the capsule has no references, so that it must not be made an object again. Its variables are
    # defaults, because a capsule may end after the variables of this module.
    kept.pop(pointer(capsule, name), None)


_destructor: Any = _Destructor(_release)
ctypes.pythonapi.Py_IncRef(ctypes.py_object(_destructor))  # for the same reason


def make_capsule(struct: QtabEnv, *needed: Any) -> Any:
    """Returns a capsule of a struct, and keeps the struct and what it needs alive as long as the capsule.

    Args:
        struct: The struct.
        needed: The objects with the memory and the code that the struct points to.
    """
    address = ctypes.addressof(struct)
    _kept[address] = (struct, *needed)
    return _new(address, NAME, ctypes.cast(_destructor, ctypes.c_void_p))

"""The memory of a machine with Windows, which has no ``sysconf``."""

import sys


def windows_memory() -> tuple[int, int]:
    """Returns the machine's memory and what of it is free, in bytes; zeros where Windows does not tell."""
    import ctypes  # loaded by few programs, and in the test of this function not for Windows

    class Status(ctypes.Structure):
        """``MEMORYSTATUSEX`` of the Windows API."""

        _fields_ = (
            ("length", ctypes.c_uint32),
            ("load", ctypes.c_uint32),
            ("total", ctypes.c_uint64),
            ("free", ctypes.c_uint64),
            ("others", ctypes.c_uint64 * 5),
        )

    status = Status(length=ctypes.sizeof(Status))
    windows = getattr(ctypes, "windll", None)
    if windows is None or not windows.kernel32.GlobalMemoryStatusEx(ctypes.byref(status)):
        return 0, 0
    return min(status.total, sys.maxsize), min(status.free, sys.maxsize)

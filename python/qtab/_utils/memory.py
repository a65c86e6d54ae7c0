"""Memory limits, checked before memory is allocated."""

import math
import os
import sys
from contextlib import suppress
from pathlib import Path

from qtab._utils import checks
from qtab._utils.shown import plural

DEFAULT_LIMIT = 4 * 2**30
"""The limit in bytes if the memory of the machine is unknown."""
BYTES_PER_EPISODE = 8 + 8 + 1
"""The size of an episode's return, length and termination flag."""
BYTES_PER_RUN = 256
"""The approximate size of a run without its episodes and tables, such as its seed in Python and in Rust."""
ALWAYS_FREE = 2**26
"""The number of bytes below which free memory is not checked, since the check takes a third of a millisecond."""
_CONTROL_GROUPS = (
    ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
    ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"),
)
"""The files with a container's memory limit and usage, in versions 2 and 1 of control groups."""


def memory_limit(value: int | None) -> int:
    """Returns the memory limit in bytes; None means half of the machine's memory.

    Raises:
        TypeError: if ``value`` is not an integer.
        ValueError: if ``value`` is less than one.
    """
    if value is not None:
        return checks.integer("memory_limit", value, least=1)
    if sys.platform == "win32":
        return _windows_memory()[0] // 2 or DEFAULT_LIMIT
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
    except (AttributeError, OSError, ValueError):
        return DEFAULT_LIMIT


def free_memory() -> int:
    """Returns the number of bytes that this process can still use, of the machine's and its control group's memory.

    Linux overcommits memory, and kills the process that writes to it. If the free memory is unknown, this is a number
    that no table reaches.
    """
    free = [sys.maxsize]
    if sys.platform == "win32":
        free.append(_windows_memory()[1] or sys.maxsize)
    with suppress(OSError, ValueError, StopIteration):
        lines = Path("/proc/meminfo").read_text(encoding="utf-8").splitlines()
        available = next(line for line in lines if line.startswith("MemAvailable:"))
        free.append(1024 * int(available.split()[1]))
    for limit, usage in _CONTROL_GROUPS:
        # "max" stands for no limit.
        with suppress(OSError, ValueError):
            free.append(int(Path(limit).read_text(encoding="utf-8")) - int(Path(usage).read_text(encoding="utf-8")))
    return max(min(free), 0)


def check_memory(what: str, needed: int, limit: int | None = None, instead: str = "") -> None:
    """Checks that data fit into a given ``memory_limit``, or else into half of the machine's memory and what is free.

    Args:
        what: The name of the data, for the message.
        needed: The number of bytes needed.
        limit: The ``memory_limit`` that the user gave; None if there is none, or if the call has no such argument.
        instead: A setting that would help, to be added to the message.

    Raises:
        MemoryError: if the data do not fit.
        TypeError: if ``limit`` is not an integer.
        ValueError: if ``limit`` is less than one.
    """
    size, most = f"{what} would take {readable_size(needed)}", memory_limit(limit)
    if limit is not None:
        if needed > most:
            raise MemoryError(
                f"{size}, more than memory_limit={limit} ({readable_size(most)}); request less, or increase "
                f"memory_limit{instead}"
            )
    elif needed > most:
        raise MemoryError(
            f"{size}, more than half of the machine's memory ({readable_size(most)}); request less{instead}"
        )
    elif needed > ALWAYS_FREE and needed > (free := free_memory()):
        raise MemoryError(f"{size}, more than the {readable_size(free)} of memory that are free; request less{instead}")


def memory_left(needed: int, limit: int | None) -> tuple[int, int]:
    """Returns the limit and the bytes left of it, which the extension takes for data that grows during runs.

    Args:
        needed: The number of bytes that the runs need in any case.
        limit: The ``memory_limit`` that the user gave, or None.
    """
    most = memory_limit(limit)
    return min(most, checks.LARGEST_COUNT), min(max(most - needed, 0), checks.LARGEST_COUNT)


def readable_size(count: int) -> str:
    """Returns a number of bytes as text in a suitable unit."""
    power = min(int(math.log2(max(count, 1))) // 10, 4)
    unit = (plural("byte", count), "KiB", "MiB", "GiB", "TiB")[power]
    number = count / 2 ** (10 * power)
    return f"{number:.0f} {unit}" if number >= 100 else f"{number:.3g} {unit}"  # .3g gives 1e+03 from 999.5 on


def _windows_memory() -> tuple[int, int]:
    """Returns the total and the free memory of a Windows machine, in bytes; zeros if unknown."""
    import ctypes  # rarely needed; the test of this function patches its windll

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

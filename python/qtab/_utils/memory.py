"""Memory limits, which are checked before memory is allocated."""

import math
import os

from qtab._utils import checks

DEFAULT_LIMIT = 4 * 2**30
"""The limit in bytes where the memory of the machine is unknown."""
BYTES_PER_EPISODE = 8 + 8 + 1
"""The size of an episode's return, length and termination flag."""
BYTES_PER_RUN = 256
"""About the size of what is kept of a run beside its episodes and tables, such as its seed in Python and in Rust."""


def memory_limit(value: int | None) -> int:
    """Returns the memory limit in bytes; None means half of the machine's memory.

    Raises:
        TypeError: if it is not an integer.
        ValueError: if it is less than one.
    """
    if value is not None:
        return checks.integer("memory_limit", value, least=1)
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
    except (AttributeError, OSError, ValueError):
        return DEFAULT_LIMIT


def check_memory(what: str, needed: int, limit: int) -> None:
    """Checks that something fits into the memory limit.

    Args:
        what: What needs the memory, for the message.
        needed: The bytes it needs.
        limit: The limit in bytes.

    Raises:
        MemoryError: if it does not fit.
    """
    if needed > limit:
        raise MemoryError(
            f"{what} need {_readable(needed)}, more than memory_limit={limit} ({_readable(limit)}); "
            "request less, or increase memory_limit"
        )


def _readable(count: int) -> str:
    power = min(int(math.log2(max(count, 1))) // 10, 4)
    return f"{count / 2 ** (10 * power):.3g} {('bytes', 'KiB', 'MiB', 'GiB', 'TiB')[power]}"

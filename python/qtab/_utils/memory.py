"""How much memory a call may take, known before it takes any."""

import math
import os

from qtab._utils import checks

LIMIT_WHERE_UNKNOWN = 4 * 2**30
BYTES_AN_EPISODE = 8 + 8 + 1
"""A return, a length and a flag."""


def memory_limit(value: int | None) -> int:
    """Returns the limit in bytes: half of the machine's memory where none is given.

    Raises:
        TypeError: if it is no integer.
        ValueError: if it is less than one.
    """
    if value is not None:
        return checks.integer("memory_limit", value, least=1)
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
    except (AttributeError, OSError, ValueError):
        return LIMIT_WHERE_UNKNOWN


def check_memory(what: str, needed: int, limit: int) -> None:
    """Refuses what needs more than the limit.

    Raises:
        MemoryError: says how much, and how to raise the limit.
    """
    if needed > limit:
        raise MemoryError(
            f"{what} need {_readable(needed)}, more than memory_limit={limit} ({_readable(limit)}); "
            f"ask for less, or raise memory_limit"
        )


def _readable(count: int) -> str:
    power = min(int(math.log2(max(count, 1))) // 10, 4)
    return f"{count / 2 ** (10 * power):.3g} {('bytes', 'KiB', 'MiB', 'GiB', 'TiB')[power]}"

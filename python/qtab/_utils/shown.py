"""Short texts of values, for error messages."""

from typing import Any

LONGEST = 450
"""The maximum number of characters; longer texts, such as those of tables, are cut in the middle."""


def shown(value: Any) -> str:
    """Returns the ``repr`` of a value, without the middle of a long one."""
    try:
        text = repr(value)
    except Exception:  # such as an integer with more digits than Python prints
        bits = f" of {value.bit_length():,} bits" if isinstance(value, int) else ""
        text = f"<{type(value).__name__}{bits}>"
    if len(text) <= LONGEST:
        return text
    half = LONGEST // 2
    return f"{text[:half]} ... {text[-half:]}"


def counted(count: int, noun: str) -> str:
    """Returns a count with its noun: ``"1 number"``, ``"2 numbers"``."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"

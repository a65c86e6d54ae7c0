"""Names of parametrized cases."""

import re
from typing import Any


def short_repr(value: Any) -> str:
    """The first 40 characters of a repr, without addresses: all workers of pytest-xdist must collect the same names."""
    return re.sub(r" at 0x[0-9a-f]+", "", repr(value))[:40]

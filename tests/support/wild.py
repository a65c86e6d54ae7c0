"""Values that no caller should give, and a limit on what they may cost."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

try:
    import resource
except ImportError:  # not on Windows
    resource = None  # type: ignore[assignment]

NUMBERS = st.one_of(
    st.integers(-2, 5),
    st.sampled_from([2**31, 2**32 - 1, 2**32, 2**53, 2**63 - 1, 2**63, 2**64 - 1, 2**64, -(2**63) - 1, 10**30]),
    st.floats(),
    st.sampled_from([0.0, -0.0, 1e308, -1e308, 5e-324, 1e-300, float("nan"), float("inf"), float("-inf")]),
)
SCALARS = st.one_of(
    NUMBERS,
    st.none(),
    st.booleans(),
    st.text(max_size=3),
    st.binary(max_size=3),
    st.just(1j),
    st.builds(object),
    st.sampled_from([np.float32(2), np.int8(-1), np.uint64(2**64 - 1), np.bool_(True), np.str_("x")]),
)
ARRAYS = st.builds(
    lambda shape, dtype: np.ones(shape, dtype),
    st.lists(st.integers(0, 3), max_size=3).map(tuple),
    st.sampled_from(["f8", "f4", "i8", "u1", "?", "c16", "U1", "O", "M8[s]"]),
)
VALUES = st.recursive(
    SCALARS | ARRAYS,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.lists(inner, max_size=3).map(tuple)
        | st.dictionaries(st.text(max_size=2) | st.integers(0, 2), inner, max_size=2)
    ),
    max_leaves=5,
)


def paths_of(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yields the path of every value within nested dicts, lists and tuples."""
    if path:
        yield path
    parts: Any = (
        value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list | tuple) else ()
    )
    for key, part in parts:
        yield from paths_of(part, (*path, key))


def replaced(value: Any, path: tuple[Any, ...], change: Any) -> Any:
    """Returns a copy of nested values in which ``change`` replaces one of them."""
    if not path:
        return change
    if isinstance(value, dict):
        return {key: replaced(part, path[1:], change) if key == path[0] else part for key, part in value.items()}
    return type(value)(replaced(part, path[1:], change) if key == path[0] else part for key, part in enumerate(value))


@contextmanager
def limited_memory(more: int) -> Iterator[None]:
    """Lets this process allocate only so many bytes more, where the system can limit it."""
    if resource is None:
        yield
        return
    try:
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    except OSError:
        yield
        return
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (used + more, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)

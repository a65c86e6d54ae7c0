"""Tables of results: NumPy columns that preserve every value, pandas data frames and Arrow tables."""

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.extras import missing

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa


_EXACT_IN_FLOATS = 2**53
"""The size up to which every integer can be represented exactly as a float."""


def integer_column(values: Sequence[int]) -> NDArray[Any]:
    """Returns (n,) integers: int64 if all fit, else uint64 if all fit, else Python integers in an object array."""
    low, high = min(values, default=0), max(values, default=0)
    for dtype in (np.int64, np.uint64):
        if np.iinfo(dtype).min <= low and high <= np.iinfo(dtype).max:
            return np.array(values, dtype)
    return _object_column(values)


def cell_column(values: Sequence[Any]) -> NDArray[Any]:
    """Returns (n,) numbers, strings, booleans and None, in an object array if their types differ.

    Integers have the dtype of :func:`integer_column`. Integers and floats together become float64, unless that would
    round an integer.
    """
    types = {type(value) for value in values}
    if types == {int}:
        return integer_column(values)
    if types == {int, float}:
        if any(isinstance(value, int) and abs(value) > _EXACT_IN_FLOATS for value in values):
            return _object_column(values)
        return np.array(values, np.float64)
    return np.array(values) if len(types) == 1 else _object_column(values)


def _object_column(values: Sequence[Any]) -> NDArray[np.object_]:
    column = np.empty(len(values), dtype=np.object_)
    column[:] = values
    return column


def data_frame(columns: Mapping[str, NDArray[Any]], integers: Collection[str] = ()) -> "pd.DataFrame":
    """Returns a data frame of columns of the same length.

    Args:
        columns: The columns by name.
        integers: The columns of floats that hold integers. They become int64, or pandas' Int64 where NaN marks a
            missing value.

    Raises:
        ModuleNotFoundError: without pandas; the message names the ``pip install``.
    """
    try:
        import pandas as pd
    except ModuleNotFoundError as error:
        raise missing(error, "pandas") from None
    frame = pd.DataFrame(dict(columns))
    for name in integers:
        has_missing = np.isnan(columns[name]).any()
        frame[name] = frame[name].astype("Int64" if has_missing else np.int64)
    return frame


def arrow_table(
    columns: Mapping[str, NDArray[Any]], integers: Collection[str] = (), texts: Collection[str] = ()
) -> "pa.Table":
    """Returns an Arrow table of columns of the same length.

    A column for which Arrow has no type becomes text: integers beyond 64 bits, or values of different types.

    Args:
        columns: The columns by name.
        integers: The columns of floats that hold integers. They become int64, with nulls for NaN.
        texts: The columns of strings and None. They become strings, with nulls for None.

    Raises:
        ModuleNotFoundError: without pyarrow.
    """
    try:
        import pyarrow as pa
    except ModuleNotFoundError as error:
        raise missing(error) from None
    types = {**dict.fromkeys(integers, pa.int64()), **dict.fromkeys(texts, pa.string())}
    arrays = {}
    for name, column in columns.items():
        if _has_different_types(column):
            arrays[name] = _text(column)
            continue
        try:
            arrays[name] = pa.array(column, types.get(name), from_pandas=True)
        except (pa.ArrowInvalid, OverflowError):  # integers that are too large
            arrays[name] = _text(column)
    return pa.table(arrays)


def _has_different_types(column: NDArray[Any]) -> bool:
    types = {type(value) for value in column if value is not None} if column.dtype == np.object_ else set()
    return len(types) > 1 and types != {int, float}


def _text(column: NDArray[Any]) -> "pa.Array":
    import pyarrow as pa

    return pa.array([None if value is None else str(value) for value in column], pa.string())


def episode_frame(
    returns: NDArray[np.float64], lengths: NDArray[np.int64], terminated: NDArray[np.bool_]
) -> "pd.DataFrame":
    """Returns a data frame with one row per episode, from arrays of (episodes,).

    Raises:
        ModuleNotFoundError: without pandas; the message names the ``pip install``.
    """
    episodes = np.arange(len(returns))
    return data_frame({"episode": episodes, "return": returns, "length": lengths, "terminated": terminated})

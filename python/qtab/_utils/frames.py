"""Tables of results as pandas data frames."""

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.extras import missing

if TYPE_CHECKING:
    import pandas as pd


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


def episode_frame(
    returns: NDArray[np.float64], lengths: NDArray[np.int64], terminated: NDArray[np.bool_]
) -> "pd.DataFrame":
    """Returns a data frame with one row per episode, from arrays of (episodes,).

    Raises:
        ModuleNotFoundError: without pandas; the message names the ``pip install``.
    """
    episodes = np.arange(len(returns))
    return data_frame({"episode": episodes, "return": returns, "length": lengths, "terminated": terminated})

"""What a sweep brings: a tidy table, a row a run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.extras import missing

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa


@dataclass(frozen=True, eq=False)
class Sweep:
    """The runs of every setting. Equal sweeps have equal tables, whatever happened on the way."""

    env: str
    """The environment's id."""
    settings: Sequence[Mapping[str, Any]]
    """What the grid gave to each setting."""
    seeds: tuple[int, ...]
    """The seeds that every setting was run with."""
    columns: Mapping[str, NDArray[Any]]
    """(runs,) each: ``setting`` (its index), the grid's names, ``seed``, the summary of the run, and ``error``."""
    block: int
    """Learning curves are the means of so many episodes."""
    _curves: Sequence[bytes]

    def __len__(self) -> int:
        return len(self.columns["seed"])

    @property
    def failed(self) -> int:
        """How many runs failed; ``error`` says why."""
        return sum(error is not None for error in self.columns["error"])

    def values(self, column: str, setting: int) -> NDArray[Any]:
        """Returns a column of one setting, in the order of the seeds, without the runs that failed.

        Raises:
            KeyError: if there is no such column.
        """
        found: NDArray[Any] = self.columns[column][self._rows(setting)]
        return found

    def curves(self, setting: int) -> NDArray[np.float64]:
        """Returns (runs, blocks): the mean returns of one setting's runs, without those that failed."""
        curves = [np.frombuffer(self._curves[row]) for row in self._rows(setting).tolist()]
        return np.array(curves) if curves else np.empty((0, 0))

    def _rows(self, setting: int) -> NDArray[np.intp]:
        whole = np.array([error is None for error in self.columns["error"]], dtype=np.bool_)
        return np.flatnonzero((self.columns["setting"] == setting) & whole)

    def to_pandas(self) -> "pd.DataFrame":
        """Returns the table as a data frame.

        Raises:
            ModuleNotFoundError: without pandas.
        """
        try:
            import pandas as pd
        except ModuleNotFoundError as error:
            raise missing(error, "stats") from None
        return pd.DataFrame(dict(self.columns))

    def to_arrow(self) -> "pa.Table":
        """Returns the table for Arrow, polars (``polars.from_arrow``) and Parquet.

        Raises:
            ModuleNotFoundError: without pyarrow.
        """
        try:
            import pyarrow as pa
        except ModuleNotFoundError as error:
            raise missing(error, "stats") from None
        texts = {"error": pa.string()}
        return pa.table({name: pa.array(column, texts.get(name)) for name, column in self.columns.items()})

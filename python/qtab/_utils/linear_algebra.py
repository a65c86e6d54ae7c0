"""Linear algebra beyond NumPy's."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def dependent_columns(matrix: NDArray[np.float64]) -> Sequence[int]:
    """Returns the columns of a matrix that are linearly dependent; none if all are independent.

    These are the columns that have a part in a linear combination that is zero up to rounding errors.
    """
    sizes = np.linalg.norm(matrix, axis=0)
    scaled = matrix / np.where(sizes > 0.0, sizes, 1.0)
    _, singular, rows = np.linalg.svd(scaled, full_matrices=True)
    tolerance = max(matrix.shape) * np.finfo(np.float64).eps * singular.max(initial=0.0)
    null_space = rows[int((singular > tolerance).sum()) :]
    parts = np.sqrt((null_space**2).sum(axis=0))
    dependent: list[int] = np.flatnonzero(parts > np.sqrt(np.finfo(np.float64).eps)).tolist()
    return dependent

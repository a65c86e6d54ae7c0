"""The tables of a run before its first episode, and whether those after the last one are finite."""

import numpy as np
from numpy.typing import NDArray

from qtab.results.run import Run


def initial_tables(run: Run) -> NDArray[np.float64]:
    """Returns (k, rows, actions): the tables before the first episode."""
    initial, shape = run.config.initial_q, run.tables.shape
    if isinstance(initial, tuple):
        from qtab.reference.streams import agent_stream

        stream = agent_stream(run.config.seed or 0, run.config.bit_generator)
        return np.stack([stream.uniform(*initial, size=shape[1:]) for _ in range(shape[0])])
    return np.broadcast_to(np.asarray(initial, dtype=np.float64).reshape(-1), (int(np.prod(shape)),)).reshape(shape)


def are_finite(run: Run) -> bool:
    """Returns whether all values are finite; those of missing actions are -inf from the start."""
    finite = np.isfinite(run.tables)
    return bool(finite.all() or (finite | np.isneginf(initial_tables(run))).all())

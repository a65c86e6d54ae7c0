"""``qtab.load_sweep``: the table of a store."""

import os

from qtab.sweeps.environments import stored_environments
from qtab.sweeps.results import Sweep, build_sweep
from qtab.sweeps.stored import read_store, store_path


def load_sweep(path: "str | os.PathLike[str]") -> Sweep:
    """Returns the finished runs of a store, which may belong to a sweep that is still running.

    The digests of the store are checked. It is logged if the runs were trained with different versions, or if the store
    is from an earlier version of this package and does not hold the versions that trained each run.

    Raises:
        OSError: if the file does not exist or cannot be read.
        StoreError: if it is not a store, is damaged or empty, or has another format version.
        TypeError: if ``path`` is not a path.
    """
    found = store_path(path)
    if not found.exists():
        raise FileNotFoundError(f"store not found: {str(found)!r}")
    contents = read_store(found)
    environments = stored_environments(contents.meta, len(contents.description.settings), found)
    return build_sweep(contents, environments=environments)

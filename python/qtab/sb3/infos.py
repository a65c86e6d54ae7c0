"""The infos of a vector environment, one dict for each sub-environment."""

from typing import Any

import numpy as np


def info_rows(infos: dict[str, Any], num_envs: int) -> list[dict[str, Any]]:
    """Returns the info of each sub-environment, from the arrays in which Gymnasium batches them.

    Args:
        infos: An array for each name, and under ``_name`` the mask of the sub-environments that have it.
        num_envs: The number of sub-environments.
    """
    rows: list[dict[str, Any]] = [{} for _ in range(num_envs)]
    for name, values in infos.items():
        mask = infos.get(f"_{name}")
        if mask is None:  # the array is a mask
            continue
        for index in np.flatnonzero(mask).tolist():
            value = values[index]
            # Numbers are Python's, as a single environment returns them.
            rows[index][name] = value.item() if isinstance(value, np.generic) else value
    return rows

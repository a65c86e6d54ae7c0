"""Observations of a space from the numbers that compiled functions write."""

from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector.utils import create_empty_array
from numpy.typing import NDArray


class VectorSpaces:
    """The spaces of an environment of one's own, as the extension module needs them for a vector environment.

    Args:
        observation_space: The space of one observation.
        action_space: The actions.
        num_envs: The number of sub-environments.
        copy: Whether each batch is new arrays. If False, it is the same arrays each time.
        mask_dtype: The dtype of the action masks in the infos; None if the infos have none.
    """

    def __init__(
        self,
        observation_space: Any,
        action_space: spaces.Discrete,
        num_envs: int,
        copy: bool,
        mask_dtype: str | None = "int8",
    ) -> None:
        self.first_action = int(action_space.start)
        """The action that is number 0."""
        self.mask_dtype = mask_dtype
        self._space = observation_space
        self._arrays = None if copy else create_empty_array(observation_space, num_envs)

    def batch(self, rows: NDArray[Any]) -> Any:
        """Returns the observations of all sub-environments, as Gymnasium batches them.

        Args:
            rows: (num_envs, numbers): the numbers of each observation, those of its parts in the order of the space.
        """
        if self._arrays is None and not isinstance(self._space, spaces.Tuple | spaces.Dict):
            return rows.reshape(len(rows), *self._space.shape).astype(self._space.dtype, copy=False)
        arrays = create_empty_array(self._space, len(rows)) if self._arrays is None else self._arrays
        _write(self._space, rows, arrays)
        return arrays

    def single(self, row: NDArray[Any]) -> Any:
        """Returns one observation, as its environment returns it.

        Args:
            row: (numbers,): its numbers.
        """
        return _single(self._space, row)


def _parts(space: Any, numbers: NDArray[Any]) -> list[tuple[Any, Any, NDArray[Any]]]:
    """Returns the key, the space and the numbers of each part of a Tuple or Dict space."""
    parts = space.spaces.items() if isinstance(space, spaces.Dict) else enumerate(space.spaces)
    found, first = [], 0
    for key, part in parts:
        size = _size(part)
        found.append((key, part, numbers[..., first : first + size]))
        first += size
    return found


def _size(space: Any) -> int:
    if isinstance(space, spaces.Dict):
        return sum(map(_size, space.spaces.values()))
    if isinstance(space, spaces.Tuple):
        return sum(map(_size, space.spaces))
    return int(np.prod(space.shape, dtype=np.int64))


def _write(space: Any, rows: NDArray[Any], arrays: Any) -> None:
    if isinstance(space, spaces.Tuple | spaces.Dict):
        for key, part, numbers in _parts(space, rows):
            _write(part, numbers, arrays[key])
    else:
        arrays[...] = rows.reshape(arrays.shape)


def _single(space: Any, row: NDArray[Any]) -> Any:
    if isinstance(space, spaces.Discrete):
        return int(row[0])
    if isinstance(space, spaces.Tuple | spaces.Dict):
        values = {key: _single(part, numbers) for key, part, numbers in _parts(space, row)}
        return tuple(values.values()) if isinstance(space, spaces.Tuple) else values
    return row.reshape(space.shape).astype(space.dtype)

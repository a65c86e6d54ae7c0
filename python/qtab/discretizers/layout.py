"""The layout of an observation space: any nesting of spaces as one row of components, in Gymnasium's order."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.discretizers.part import Part, parts_of, restored_part


@dataclass(frozen=True)
class Layout:
    """The parts of an observation space, in Gymnasium's order: that of ``Dict.spaces`` and of ``Tuple.spaces``."""

    parts: tuple[Part, ...]

    @classmethod
    def of_space(cls, space: Any) -> "Layout":
        """Returns the layout of an observation space.

        Raises:
            ValueError: if a table cannot represent the space; the message suggests a remedy.
        """
        layout = cls(tuple(parts_of(space, space)))
        if not layout.size:
            raise ValueError(f"the observation space must have at least one component, got {space}")
        return layout

    @property
    def size(self) -> int:
        """The number of components."""
        return sum(part.size for part in self.parts)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """A name for each component."""
        return tuple(name for part in self.parts for name in part.names())

    @cached_property
    def spans(self) -> tuple[slice, ...]:
        """The components of each part."""
        ends = accumulate(part.size for part in self.parts)
        return tuple(slice(end - part.size, end) for part, end in zip(self.parts, ends, strict=True))

    def keys(self) -> dict[str, list[Part]]:
        """Returns the parts under each key of the outermost Dict, or each index of the outermost Tuple."""
        found: dict[str, list[Part]] = {}
        for part in self.parts:
            if part.path:
                found.setdefault(str(part.path[0]), []).append(part)
        return found

    def components(self, parts: "list[Part] | tuple[Part, ...]") -> list[int]:
        """Returns the indices of the components of some parts."""
        spans = [span for part, span in zip(self.parts, self.spans, strict=True) if part in parts]
        return [component for span in spans for component in range(span.start, span.stop)]

    def name_of(self, component: int) -> str:
        """Returns the name of a component in messages: ``observation['agent'][0]``."""
        for part in self.parts:
            if component < part.size:
                index = [str(number) for number in np.unravel_index(component, part.shape)] if part.shape else []
                return part.name + (f"[{', '.join(index)}]" if index else "")
            component -= part.size
        raise IndexError(component)

    def batch_size(self, observation: Any) -> int | None:
        """Returns the number of observations, batched as in Gymnasium's vector environments; None for a single one.

        Raises:
            ValueError: if an observation does not have the shape of the space.
        """
        if self._is_flat(observation):
            shape = np.shape(observation)
            return shape[0] if len(shape) == 2 else None
        counts = set()
        for part in self.parts:
            shape = part.find(observation).shape
            if shape != part.shape and shape[1:] != part.shape:
                raise ValueError(f"{part.name} must have shape {part.shape}, the space's, got {shape}")
            counts.add(None if shape == part.shape else shape[0])
        if len(counts) > 1:
            raise ValueError(f"observations must be batched alike in all their parts, got {sorted(map(str, counts))}")
        if isinstance(observation, list) and self.parts[0].path and counts != {None}:
            raise ValueError(
                "observations of a Tuple space must be batched as a tuple with an array for each part, as Gymnasium's "
                "vector environments do, got a list"
            )
        return counts.pop()

    def flat(
        self,
        observation: Any,
        dtype: Any,
        first: Sequence[NDArray[np.int64] | None],
        batch: int | None = None,
    ) -> NDArray[Any]:
        """Returns the components of an observation, (size,), or of a batch, (n, size).

        Args:
            observation: An observation, or a batch.
            dtype: The dtype of the result.
            first: The numbers to subtract from each part whose components are indices; None for other parts.
            batch: The number of observations; None for a single one.

        Raises:
            TypeError: if components are not numbers of the kinds that the space has.
            ValueError: if an observation does not have the shape of the space.
        """
        shape = () if batch is None else (batch,)
        flat = np.empty((*shape, self.size), dtype=dtype)
        for components, values in self.numbers(observation, first, shape):
            flat[..., components] = values
        return flat

    def numbers(
        self, observation: Any, first: Sequence[NDArray[np.int64] | None], shape: tuple[int, ...]
    ) -> Iterator[tuple[slice, NDArray[Any]]]:
        """Yields for each part its components and their numbers, (*shape, components): int64 where they are indices.

        Args:
            observation: An observation, or a batch.
            first: As for :meth:`flat`.
            shape: The shape of the batch, () or (n,).

        Raises:
            TypeError: if components are not numbers of the kinds that the space has.
            ValueError: if an observation does not have the shape of the space.
        """
        is_flat = self._is_flat(observation)
        for part, components, offset in zip(self.parts, self.spans, first, strict=True):
            values = observation[..., components] if is_flat else part.find(observation)
            if not is_flat:
                if values.shape != (*shape, *part.shape):
                    raise ValueError(f"{part.name} must have shape {part.shape}, the space's, got {values.shape}")
                values = values.reshape(*shape, part.size)
            elif offset is not None and values.dtype.kind == "f":
                values = np.rint(values)  # the cell of an index extends 0.5 to either side
            values = part.numbers(values)
            yield components, values if offset is None else values.astype(np.int64) - offset

    def split(self, observation: Any, count: int | None) -> list[Any]:
        """Returns a list of ``count`` batched observations in the structure of the space; None means a single one."""
        is_flat = self._is_flat(observation)
        if count is None and not is_flat:
            return [observation]
        columns = []
        for part, span in zip(self.parts, self.spans, strict=True):
            column = np.reshape(observation, (-1, self.size))[:, span] if is_flat else part.find(observation)
            if is_flat and part.kind != "float":
                column = np.rint(column).astype(np.int64)
            columns.append((part.path, column.reshape(-1, *part.shape)))
        return [
            _nested([(path, column[index]) for path, column in columns])
            for index in range(1 if count is None else count)
        ]

    def _is_flat(self, observation: Any) -> bool:
        """Returns whether it is one array of the components of a nested space or of a Box with several axes."""
        if not isinstance(observation, np.ndarray) or observation.dtype.kind not in "iubf":
            return False
        shape = observation.shape
        nested = bool(self.parts[0].path)
        of_box = len(shape) <= 2 < len(self.parts[0].shape) + 1 and shape != self.parts[0].shape
        return (nested or of_box) and shape[-1:] == (self.size,) and len(shape) <= 2

    def to_json(self) -> str:
        """Returns the layout as JSON text, for a file."""
        return json.dumps([vars(part) for part in self.parts])

    @classmethod
    def from_json(cls, text: str) -> "Layout":
        """Returns the layout in a file, after checking it.

        Raises:
            KeyError: if a key is missing.
            ValueError: if ``text`` is not a layout.
        """
        parts = tuple(restored_part(part) for part in json.loads(text))
        if not parts or not sum(part.size for part in parts):
            raise ValueError("its observations have no components")
        return cls(parts)


def _nested(parts: list[tuple[tuple[str | int, ...], Any]]) -> Any:
    """Builds an observation from its parts: a dict if their keys are strings, a tuple if they are indices."""
    if not parts[0][0]:
        return parts[0][1]
    groups: dict[str | int, list[tuple[tuple[str | int, ...], Any]]] = {}
    for path, value in parts:
        groups.setdefault(path[0], []).append((path[1:], value))
    built = {key: _nested(group) for key, group in groups.items()}
    return tuple(built.values()) if isinstance(parts[0][0][0], int) else built

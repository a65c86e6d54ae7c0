"""Observations of any nesting of spaces: discrete components index the table, continuous ones are discretized."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab import _core
from qtab._spec import DiscretizerSpec, FactorSpec, IdentitySpec
from qtab.config import Config
from qtab.discretizers.base import Discretizer, check_table_size
from qtab.discretizers.groups import Group, choose_groups
from qtab.discretizers.layout import Layout
from qtab.discretizers.part import too_large

_NUMBERED = re.compile(r"^(observation|observations\[\d+\])\[(\d+)\] is ([^,]+),")
"""The extension's name for a component: it receives one row of numbers."""

MAX_RESTORED_BINS = 10**7
"""The maximum number of bins of a file along all components: more would take much more memory than its size."""


@dataclass(frozen=True, eq=False, repr=False)
class Composite(Discretizer):
    """The components of a :class:`Layout`: each is an index, or belongs to a :class:`Group`.

    A grid has an axis for each component, in the order of the layout. With tile coding, each combination of the other
    components has separate tilings.
    """

    reads_space = True

    layout: Layout
    groups: tuple[Group, ...]
    by_key: Mapping[str, Mapping[str, Any]] | None
    """The setting ``discretizer`` if it maps keys to discretizers; otherwise None."""

    @classmethod
    def build(cls, space: Any, config: Config, n_actions: int) -> "Composite":
        """Returns the discretizer of any observation space that consists of numbers.

        Raises:
            ValueError: if the space or an option does not fit, or the table would be too large.
        """
        return cls.of_layout(Layout.of_space(space), config, n_actions)

    @classmethod
    def of_layout(cls, layout: Layout, config: Config, n_actions: int) -> "Composite":
        """Returns the discretizer of a layout; see :meth:`build`."""
        groups = choose_groups(layout, config, n_actions)
        low, high = (
            np.array([bound for part in layout.parts for bound in getattr(part, name)]) for name in ("low", "high")
        )
        chosen: Any = config.discretizer
        composite = cls(low, high, layout, groups, chosen if isinstance(chosen, Mapping) else None)
        if n_actions:
            with np.errstate(over="ignore"):
                tiled = (group.discretizer.n_rows for group in groups if not group.discretizer.has_cells)
                values = math.prod(float(count or 1) for count in (*composite.counts, *tiled)) * n_actions
            names = composite.component_names
            given = f"{len(names)} components ({', '.join(names[:4])}{', ...' if len(names) > 4 else ''})"
            check_table_size("the observation space", given, values, too_large(layout.parts))
        return composite

    @classmethod
    def restore(cls, config: Config, arrays: Mapping[str, NDArray[Any]], n_rows: int) -> "Composite":
        """Returns the discretizer of a saved run; see :meth:`Discretizer.restore`."""
        by_key: Any = config.discretizer.values() if isinstance(config.discretizer, Mapping) else ()
        if sum(sum(options.get("bins") or ()) for options in (*by_key, vars(config))) > MAX_RESTORED_BINS:
            raise ValueError("its bins are too many")
        composite = cls.of_layout(Layout.from_json(str(arrays["layout"])), config, 0)
        if config.max_rows is None and composite.n_rows != n_rows:
            raise ValueError("its table has another number of rows than its discretizer")
        return composite

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Returns the arrays to save."""
        return {"layout": np.array(self.layout.to_json())}

    def settings(self) -> dict[str, Any]:
        """Returns the options of the discretizers that were derived from the space, by key if chosen by key."""
        if not self.groups:
            return {}
        if self.groups[0].key is None:
            return self.groups[0].discretizer.settings()
        complete = {key: dict(options) for key, options in (self.by_key or {}).items()}
        for group in self.groups:
            complete[str(group.key)] |= group.discretizer.settings()
        return {"discretizer": complete}

    @property
    def component_names(self) -> tuple[str, ...]:
        """A name for each component, such as ``agent[0]``."""
        return self.layout.names

    @cached_property
    def _owners(self) -> dict[int, Group]:
        """The group of each component that is not an index."""
        return {component: group for group in self.groups for component in group.components}

    @cached_property
    def _tiles(self) -> Group | None:
        """The group that is tiled."""
        return next((group for group in self.groups if not group.discretizer.has_cells), None)

    @property
    def has_cells(self) -> bool:  # type: ignore[override]
        """Whether no component is tiled."""
        return self._tiles is None

    @cached_property
    def counts(self) -> tuple[int, ...]:
        """The number of rows of each component: 0 for tiled components and integers without bounds."""
        spans = (last - first for first, last in self._bounds)
        counts = [int(span) + 1 if math.isfinite(span) else 0 for span in spans]
        for group in self.groups:
            sizes = group.discretizer.shape if group.discretizer.has_cells else (0,) * len(group.components)
            for component, size in zip(group.components, sizes, strict=True):
                counts[component] = size
        return tuple(counts)

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of cells along each component; ``(n_rows,)`` with tile coding."""
        if self._tiles is None:
            return self.counts
        return (math.prod(count or 1 for count in self.counts) * self._tiles.discretizer.n_rows,)

    @property
    def n_active(self) -> int:
        """The number of tilings, or 1."""
        return 1 if self._tiles is None else self._tiles.discretizer.n_active

    def cell_edges(self) -> tuple[NDArray[np.float64], ...]:
        """Returns the edges of the cells; for an index, the midpoints between the integers."""
        grouped = {
            component: edges
            for group in self.groups
            for component, edges in zip(group.components, group.discretizer.cell_edges(), strict=True)
        }
        return tuple(
            grouped[component] if component in grouped else low - 0.5 + np.arange(count + 1.0)
            for component, ((low, _), count) in enumerate(zip(self._bounds, self.counts, strict=True))
        )

    @cached_property
    def _bounds(self) -> list[tuple[float, float]]:
        return [bounds for part in self.layout.parts for bounds in zip(part.low, part.high, strict=True)]

    @cached_property
    def _is_whole(self) -> bool:
        """Whether one group has all the components."""
        return len(self.groups) == 1 and self.groups[0].components == tuple(range(self.layout.size))

    def spec(self) -> DiscretizerSpec:
        """Returns the discretizer as the extension takes it, for the flat arrays of :meth:`observe`."""
        if self._is_whole:
            return self.groups[0].discretizer.spec()
        if not self.groups:
            return {"type": "identity", "first": [0] * self.layout.size, "counts": self.counts, "scalar": False}
        factors, stride = list[FactorSpec](), 1
        if self._tiles is not None:
            of_tiles = self._tiles.discretizer
            factors.append({"components": self._tiles.components, "stride": 1, "discretizer": of_tiles.spec()})
            stride = of_tiles.n_rows
        for component in reversed(range(self.layout.size)):
            count = self.counts[component]
            if not count:
                continue
            index: IdentitySpec = {"type": "identity", "first": [0], "counts": [count], "scalar": True}
            spec = self._owners[component].spec_of(component) if component in self._owners else index
            factors.append({"components": [component], "stride": stride, "discretizer": spec})
            stride *= count
        return {"type": "product", "dimensions": self.layout.size, "factors": factors}

    @property
    def flat_first(self) -> list[int]:  # type: ignore[override]
        """The numbers that :meth:`observe` subtracts from the components, so that indices begin at 0."""
        pairs = zip(self._first, self.layout.parts, strict=True)
        return [int(low) for first, part in pairs for low in ([0] * part.size if first is None else first)]

    @cached_property
    def _first(self) -> list[NDArray[np.int64] | None]:
        """The first integers of each part whose components are indices; None for other parts."""
        return [
            None
            if span.start in self._owners
            else np.array([int(low) if math.isfinite(low) else 0 for low in part.low], np.int64)
            for part, span in zip(self.layout.parts, self.layout.spans, strict=True)
        ]

    @cached_property
    def _dtype(self) -> "np.dtype[Any]":
        if not self.groups:
            return np.dtype(np.int64)
        return np.dtype(self.groups[0].discretizer.dtype if self._is_whole else np.float64)

    def flat(self, observation: Any) -> NDArray[Any]:
        """Returns (d,), or (n, d) for n observations: the components as the extension reads them."""
        return self.layout.flat(observation, self._dtype, self._first, self.layout.batch_size(observation))

    def observe(self, observation: Any) -> NDArray[Any]:
        """Returns (d,): the components of an observation as the extension reads them, with indices from 0.

        Raises:
            TypeError: if the observation does not hold numbers (integers for discrete spaces).
            ValueError: if the observation does not have the shape of the space.
        """
        return self.layout.flat(observation, self._dtype, self._first)

    def along_axes(self, observation: Any) -> NDArray[Any]:
        """Returns (d,): the components of an observation."""
        return self.layout.flat(observation, np.float64, [None] * len(self.layout.parts))

    def active_rows(self, observation: Any) -> NDArray[np.int64]:
        """Returns the (n_active,) rows of an observation, or the (n, n_active) rows of n observations.

        Observations have the structure of the space; n of them are batched as in Gymnasium's vector environments.
        Observations of a nested space may also be one array of all components, (d,) or (n, d).

        Raises:
            TypeError: if the observation does not hold numbers (integers for discrete spaces).
            ValueError: if the observation does not have the shape of the space, or has no row.
        """
        try:
            return self._compiled.active_rows(self.flat(observation))
        except ValueError as error:
            raise ValueError(self.in_terms_of_space(str(error))) from None

    def in_terms_of_space(self, message: str) -> str:
        """Translates a message of the extension to the keys of a component and the number given by the user."""

        def as_given(found: re.Match[str]) -> str:
            which, component, number = found[1], int(found[2]), found[3]
            if self._indices[0][component] and number.lstrip("-").isdecimal():
                number = str(int(number) + self._bounds[component][0])
            return f"{which}{self.layout.name_of(component).removeprefix('observation')} is {number},"

        return _NUMBERED.sub(as_given, message)

    def split(self, observation: Any, count: int | None) -> list[Any]:
        """Returns a list of ``count`` observations in the structure of the space; None means a single one."""
        return self.layout.split(observation, count)

    def cells(self, observation: Any) -> NDArray[np.int64]:
        """Returns (d,): the index of one observation along each component, for any number of cells.

        Raises:
            TypeError: if the observation does not hold numbers (integers for discrete spaces).
            ValueError: if the observation does not have the shape of the space or lies outside it.
        """
        return self._cells(observation, ())

    def cells_of(self, observation: Any) -> NDArray[np.int64]:
        """Returns (d,) like :meth:`cells`, or (n, d) for n observations."""
        count = self.layout.batch_size(observation)
        return self._cells(observation, () if count is None else (count,))

    @cached_property
    def _indices(self) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
        """A mask of the components that are indices, and the number of their values, huge for unbounded integers."""
        indices = np.array([component not in self._owners for component in range(self.layout.size)])
        return indices, np.array([count or 2**62 for count in self.counts])

    @cached_property
    def _of_components(self) -> dict[int, tuple[_core.Discretizer, str]]:
        """The discretizer and the dtype of each component that is not an index."""
        return {
            component: (_core.Discretizer(group.spec_of(component)), group.discretizer.dtype)
            for component, group in self._owners.items()
        }

    def _cells(self, observation: Any, shape: tuple[int, ...]) -> NDArray[np.int64]:
        indices, counts = self._indices
        cells = np.empty((*shape, self.layout.size), np.int64)
        for components, numbers in self.layout.numbers(observation, self._first, shape):
            if indices[components].any():
                cells[..., components] = numbers  # never as floats, which cannot represent every integer
                continue
            for component, column in zip(range(components.start, components.stop), numbers.T, strict=True):
                discretizer, dtype = self._of_components[component]
                as_read = column.astype(self._dtype).astype(dtype)[..., np.newaxis]
                cells[..., component] = discretizer.active_rows(as_read)[..., 0]
        bounded = counts < 2**62
        outside = indices & bounded & ((cells < 0) | (cells >= counts))
        if outside.any():
            *_, component = np.argwhere(outside)[0]
            value = int(cells[..., component][outside[..., component]].flat[0]) + self._bounds[component][0]
            raise ValueError(f"{self.layout.name_of(component)} is {value}, outside the observation space")
        return cells

    def same_space(self, other: Discretizer) -> bool:
        """Returns whether another discretizer takes observations with the same components."""
        return super().same_space(other) and self.component_names == other.component_names

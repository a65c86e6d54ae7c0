"""Groups the components of an observation that are discretized, each with its discretizer; the others are indices."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium import spaces

from qtab._utils.shown import did_you_mean, shown
from qtab.config import Config
from qtab.config.choices import MAPPING
from qtab.config.config import replace_checked
from qtab.config.options import OPTIONS
from qtab.config.validation import defaults, kind
from qtab.discretizers.bins import Bins
from qtab.discretizers.box import BoxDiscretizer
from qtab.discretizers.edges import Edges
from qtab.discretizers.layout import Layout
from qtab.discretizers.part import Part
from qtab.discretizers.rounding import Rounding
from qtab.discretizers.tile_coding import TileCoding

OF_BOXES: Mapping[str, type[BoxDiscretizer]] = {"round": Rounding, "bins": Bins, "edges": Edges, "tiles": TileCoding}
_OPTIONS = [name for name, option in OPTIONS.items() if option.choice == "discretizer"]


@dataclass(frozen=True, eq=False)
class Group:
    """Components that one Box discretizer divides together."""

    components: tuple[int, ...]
    discretizer: BoxDiscretizer
    key: str | None = None
    """The key that the user chose the discretizer for; None if one discretizer serves all non-index components."""

    def spec_of(self, component: int) -> Any:
        """Returns the spec of one component of a grid."""
        index = self.components.index(component)
        spec: Mapping[str, Any] = self.discretizer.spec()
        return {name: [value[index]] if isinstance(value, list) else value for name, value in spec.items()}


def choose_groups(layout: Layout, config: Config, n_actions: int) -> tuple[Group, ...]:
    """Returns the groups of a layout by the setting ``discretizer``.

    Args:
        layout: The layout.
        config: The config, with the defaults of its options filled in.
        n_actions: The number of values in a row of the table; 0 if rows are assigned when observations are seen.

    Raises:
        ValueError: if the discretizer does not fit the layout.
    """
    if kind(config.discretizer) == MAPPING:
        return _by_key(layout, config, n_actions)
    if config.discretizer == "identity":
        _check_indices(layout.parts, config, "discretizer")
        return ()
    # The floats and the integers with many values, or, if there are none, all integers.
    divided = [part for part in layout.parts if not part.is_small and not (part.kind == "integer" and config.max_rows)]
    parts = divided or [part for part in layout.parts if part.kind == "integer"]
    if not parts:
        raise ValueError(
            "discretizer must be left out for an observation space of discrete parts alone, got "
            f"{shown(config.discretizer)}"
        )
    return (_group(layout, parts, config, n_actions),)


def is_discrete(layout: Layout, config: Config) -> bool:
    """Returns whether observations index the table unless another discretizer is given."""
    if config.max_rows is not None:
        return all(part.kind != "float" for part in layout.parts)
    return all(part.is_small for part in layout.parts)


def _check_indices(parts: Any, config: Config, name: str) -> None:
    for part in parts:
        if part.kind == "float" or not (part.is_bounded or config.max_rows):
            what = "floats" if part.kind == "float" else "integers without bounds"
            raise ValueError(
                f"{name} must be 'bins', 'tiles' or another one for {what}, which {part.name} holds, got 'identity'"
            )


def _by_key(layout: Layout, config: Config, n_actions: int) -> tuple[Group, ...]:
    chosen: Mapping[str, Mapping[str, Any]] = config.discretizer  # type: ignore[assignment]
    keys = layout.keys()
    groups = []
    for key, options in chosen.items():
        name = f"discretizer[{key!r}]"
        if key not in keys:
            if not keys:
                raise ValueError(
                    "discretizer must be a name or a function for an observation space without keys, "
                    f"got {shown(chosen)}"
                )
            raise ValueError(
                f"{name} does not fit the observation space, {key!r} is not one of its keys: "
                f"{', '.join(map(repr, keys))}{did_you_mean(key, list(keys))}"
            )
        empty = dict.fromkeys(_OPTIONS) | {"scale": ()}
        of_key = replace_checked(config, **{**empty, **options, "max_rows": config.max_rows})
        of_key = replace_checked(of_key, **defaults(vars(of_key)))
        if of_key.discretizer == "identity":
            _check_indices(keys[key], config, name)
            continue
        parts = [part for part in keys[key] if part.kind != "index"]
        if not parts:
            raise ValueError(f"{name} must be 'identity' or left out, since it is discrete, got {shown(options)}")
        try:
            groups.append(_group(layout, parts, of_key, n_actions, key))
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None
    for key, parts in keys.items():
        if key not in chosen and not all(
            part.is_small or (part.kind == "integer" and config.max_rows) for part in parts
        ):
            raise ValueError(
                f"discretizer must have a value for {key!r} as well, which is not discrete: {shown(chosen)}"
            )
    tiled = [group.key for group in groups if not group.discretizer.has_cells]
    if len(tiled) > 1:
        raise ValueError(
            f"discretizer must be 'tiles' for one key at most, got {' and '.join(map(repr, tiled))}; "
            "discretizer='tiles' tiles all of them together"
        )
    return tuple(groups)


def _group(layout: Layout, parts: list[Part], config: Config, n_actions: int, key: str | None = None) -> Group:
    dtype: Any = np.float32 if all(part.single for part in parts) else np.float64
    bounds: Any = [
        np.array([bound for part in parts for bound in getattr(part, name)], dtype) for name in ("low", "high")
    ]
    many = next((part for part in parts if part.kind == "integer" and not part.is_small), None)
    if many is not None and config.discretizer == "round" and not config.scale:
        found = f"integers from {min(many.low)} to {max(many.high)}" if many.is_bounded else "integers without bounds"
        raise ValueError(
            f"{many.name} holds {found}, too many for a row each: max_rows= assigns rows only to the observations "
            "that are seen, and discretizer='bins' or 'tiles' with low= and high= divides a range of them"
        )
    box = spaces.Box(*bounds, dtype=dtype)
    discretizer = OF_BOXES[str(config.discretizer)].build(box, config, n_actions)
    assert isinstance(discretizer, BoxDiscretizer)  # noqa: S101 - for type checkers
    return Group(tuple(layout.components(parts)), discretizer, key)

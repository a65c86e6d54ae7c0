"""The meaning of the axes of a run's tables: the components of the observation, and the actions."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import counted
from qtab.config import Config
from qtab.config.origin import trained_on
from qtab.envs.actions import Actions
from qtab.envs.metadata.quantities import (
    UNKNOWN,
    Quantities,
    Quantity,
    behind,
    observation_quantities,
    observed_quantities,
    tabulated_quantities,
)
from qtab.envs.registry import TABULAR, TABULATED, entry_for_id

if TYPE_CHECKING:
    from qtab.discretizers import Discretizer


@dataclass(frozen=True, eq=False, repr=False)
class Axis:
    """A component of the observation and its cells."""

    name: str
    """The name in Gymnasium's documentation, in lower case, such as ``"position"``; for an unknown environment
    ``"state"`` if the observation is one integer, else ``"observation[0]"`` and so on."""
    unit: str
    """The unit; empty if there is none or it is unknown."""
    edges: NDArray[np.float64]
    """(cells + 1,): the ascending edges of the cells. With tile coding, the edges of an unshifted tiling; for integers,
    the midpoints. The outermost edges are those of the space or of the discretizer; they can be infinite. With weighted
    features, which have no cells, (2,): the limits."""
    values: tuple[str, ...] = ()
    """The names of the cells, if they have any, such as ``("no", "yes")``."""
    has_cells: bool = True
    """Whether the component is divided into cells or tiles."""

    @property
    def label(self) -> str:
        """The name and the unit: ``"position (m)"``."""
        return Quantity(self.name, self.unit).label

    def __repr__(self) -> str:
        """Returns one line, without the edges."""
        cells = len(self.edges) - 1
        within = f"from {self.edges[0]:.6g} to {self.edges[-1]:.6g}" if cells else "of one value"
        divided = f"{counted(cells, 'cell')} " if self.has_cells else ""
        return f"<Axis {self.label}: {divided}{within}>"


def run_quantities(config: Config, discretizer: "Discretizer") -> Quantities:
    """Returns the names and units of the observations and actions of a run, as far as they are known."""
    known = observed_quantities(config.env, discretizer.low, discretizer.high)
    environment = trained_on(config)
    if environment is None:  # a file of an earlier version
        return known
    entry = entry_for_id(config.env.rpartition(":")[2])
    if entry is None or _bare_class(environment.cls) not in (
        entry.gymnasium_entry_point,
        _bare_class(entry.entry_point),
    ):
        if environment.cls == TABULATED:
            return tabulated_quantities(environment.attributes)
        return known if environment.cls == TABULAR.entry_point else UNKNOWN
    return behind(known, (wrapper.cls for wrapper in environment.wrappers))


def _bare_class(cls: str) -> str:
    """Returns a class without its module if it is one of this package's: files of earlier versions name another."""
    return cls.rpartition(":")[2] if cls.startswith("qtab.") else cls


def axes_of(known: Quantities, discretizer: "Discretizer") -> tuple[Axis, ...]:
    """Returns an axis for each component of the observations; with ``time_aware`` the steps taken come first."""
    edges = discretizer.cell_edges()
    if discretizer.is_time_aware:
        time_aware: Any = discretizer
        return (Axis("steps taken", "", edges[0]), *axes_of(known, time_aware.cells))
    named = tuple(map(Quantity, discretizer.component_names))
    quantities = named or observation_quantities(known, len(edges))
    has_cells = not discretizer.is_weighted
    return tuple(
        Axis(one.name, one.unit, found, one.values, has_cells) for one, found in zip(quantities, edges, strict=True)
    )


def action_names(known: Quantities, actions: Actions) -> tuple[str, ...]:
    """Returns a name for each action: Gymnasium's word, the value of a continuous action, or ``"action 2"``."""
    if actions.values is not None:
        quantities = known.continuous_actions
        components = actions.values.reshape(len(actions), -1)
        if len(quantities) != components.shape[1]:
            quantities = ()
        return tuple(_named_values(action.tolist(), quantities) for action in components)
    if actions.composite is not None:
        return tuple(_named_parts(action) for action in actions.objects())
    named = known.actions if len(known.actions) == len(actions) or known.layout == "" else ()
    neutral = [f"action {actions.first + index}" for index in range(len(actions))]
    return (*named, *neutral[len(named) :])[: len(actions)]


def _named_parts(action: Any) -> str:
    """Returns the numbers of a composite action as text, with the keys of a dict."""
    if isinstance(action, dict):
        return "{" + ", ".join(f"{key}: {_named_parts(part)}" for key, part in action.items()) + "}"
    if isinstance(action, tuple):
        return "(" + ", ".join(map(_named_parts, action)) + ")"
    return str(action) if isinstance(action, int) else _named_values(action.ravel().tolist(), ())


def _named_values(values: Sequence[float], quantities: Sequence[Quantity]) -> str:
    if not quantities:
        text = ", ".join(f"{value:g}" for value in values)
        return text if len(values) == 1 else f"({text})"
    return ", ".join(
        f"{known.name} {value:g}{' ' + known.unit if known.unit else ''}"
        for known, value in zip(quantities, values, strict=True)
    )

"""The origin of a run's config, which it stores besides its settings."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from qtab.envs.origin.description import EnvironmentDescription

C = TypeVar("C", bound="WithOrigin")


@dataclass(frozen=True)
class Origin:
    """The environment that a run was trained on, and the names of the derived settings.

    Settings that were not given are filled in when training begins. Those that follow from the environment or from
    other settings are derived: they are derived again for another environment, or with other settings.
    """

    environment: "EnvironmentDescription | None" = None
    """The environment of the training; None if it is not known."""
    derived: frozenset[str] = frozenset()
    """The names of the settings that were derived."""

    @property
    def derived_again(self) -> frozenset[str]:
        """The settings that a new training derives again; all derived ones if the environment is not known."""
        return self.derived if self.environment is None else self.derived & {"backend"}

    def as_json(self) -> dict[str, Any]:
        """Returns the origin as stored in files."""
        environment = None if self.environment is None else self.environment.as_json()
        return {"environment": environment, "derived": sorted(self.derived)}

    def without(self, names: Iterable[str]) -> "Origin":
        """Returns the origin after some settings were given."""
        return replace(self, derived=self.derived.difference(names))


class WithOrigin:
    """Gives a config its origin, which is not a setting: ``vars(config)`` holds only the settings."""

    __slots__ = ("_origin",)

    @property
    def origin(self) -> Origin | None:
        """The origin of a run's config; None for any other config, and in files of earlier versions."""
        found: Origin | None = getattr(self, "_origin", None)
        return found

    def __setstate__(self, state: object) -> None:
        """Restores a copy or a pickled config, which is frozen."""
        settings, slots = state if isinstance(state, tuple) else (state, {})
        vars(self).update(settings)
        for name, value in (slots or {}).items():
            object.__setattr__(self, name, value)


def copied(config: C, origin: Origin | None) -> C:
    """Returns a copy of a config with another origin."""
    copy = object.__new__(type(config))
    vars(copy).update(vars(config))
    if origin is not None:
        object.__setattr__(copy, "_origin", origin)
    return copy


def trained_on(config: WithOrigin) -> "EnvironmentDescription | None":
    """Returns the environment that the run of a config was trained on; None if it is not known."""
    return None if config.origin is None else config.origin.environment

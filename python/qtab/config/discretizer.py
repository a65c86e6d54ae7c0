"""The setting ``discretizer``: a name, a function, or a name and its options for each key of the observation."""

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from qtab._utils import checks
from qtab._utils.shown import shown
from qtab._utils.suggestions import did_you_mean
from qtab.config.choices import CHOICES

if TYPE_CHECKING:
    from qtab.config.config import Config

FUNCTION = "function"
MAPPING = "mapping"


def kind(discretizer: Any) -> str:
    """Returns the name of a discretizer; ``"function"`` or ``"mapping"`` for one that is given as such."""
    if isinstance(discretizer, Mapping):
        return MAPPING
    return FUNCTION if callable(discretizer) else str(discretizer)


def uses_tiles(discretizer: Any) -> bool:
    """Whether a discretizer is, or contains, tile coding: no state has a row of its own then."""
    if isinstance(discretizer, Mapping):
        return any(of_key["discretizer"] == "tiles" for of_key in discretizer.values())
    return bool(discretizer == "tiles")


def checked_discretizer(name: str, value: Any) -> Any:
    """Returns the setting, checked: that of a key as a mapping with its name and the options that are given.

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for an unknown name, or an option that does not fit.
    """
    if isinstance(value, Mapping):
        if not value:
            raise ValueError(f"{name} must name a discretizer for at least one key of the observation, got {{}}")
        return {_key(name, key): _of_key(f"{name}[{key!r}]", given) for key, given in value.items()}
    if callable(value) and not isinstance(value, str):
        return value
    return checks.choice(name, value, CHOICES[name])


def _key(name: str, key: Any) -> str:
    if isinstance(key, bool) or not isinstance(key, str | int):
        raise TypeError(f"{name} must have texts or integers as keys, those of the observation, got {shown(key)}")
    return str(key)


def _of_key(name: str, given: Any) -> dict[str, Any]:
    from qtab.config.config import Config
    from qtab.config.options import OPTIONS, defaults, is_set

    options = {"discretizer": given} if isinstance(given, str) else given
    if not isinstance(options, Mapping):
        raise TypeError(f"{name} must be a name or a mapping of a name and its options, got {shown(given)}")
    known = ["discretizer", *(option for option, of in OPTIONS.items() if of.choice == "discretizer")]
    known = [option for option in known if option not in ("shape", "max_rows")]
    for option in options:
        if option not in known:
            raise ValueError(f"{name} has an unknown option {option!r}{did_you_mean(str(option), known)}")
    if not isinstance(options.get("discretizer"), str):
        raise TypeError(f"{name} must name its discretizer, got {shown(given)}")
    try:
        config = Config(**{"learning_rate": 0.0, **options})
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name}: {error}") from None
    complete = vars(config) | defaults(vars(config))
    return {option: complete[option] for option in known if is_set(complete[option])}


@dataclass(frozen=True)
class MissingFunction:
    """Stands for the function that was the discretizer of a saved run: files hold its name alone."""

    name: str

    def __call__(self, observation: Any) -> Any:  # noqa: ARG002
        """Says how to load the run with its function.

        Raises:
            ValueError: always.
        """
        raise ValueError(
            f"the run's discretizer is the function {self.name!r}, which a file cannot hold: "
            "qtab.load(path, discretizer=...) takes it"
        )


def function_name(function: Callable[[Any], Any]) -> str:
    """Returns the name by which a saved run remembers its function."""
    if isinstance(function, MissingFunction):
        return function.name
    return str(getattr(function, "__qualname__", type(function).__qualname__))


LEFT_OUT = ("shape", "max_rows")
"""Settings that files and stores leave out where they have no value, because earlier versions did not have them."""


def stored_fields(config: "Config") -> dict[str, Any]:
    """Returns the settings of a config as files and stores hold them."""
    fields = ((field.name, getattr(config, field.name)) for field in dataclasses.fields(config))
    return {name: value for name, value in fields if name not in LEFT_OUT or value is not None}


def stored_function(config: dict[str, Any]) -> dict[str, str]:
    """Takes a function out of the fields of a config; returns what a file holds of it, nothing where there is none."""
    function = config["discretizer"]
    if kind(function) != FUNCTION:
        return {}
    config["discretizer"] = None
    return {"discretizer_function": function_name(function)}

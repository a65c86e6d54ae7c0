"""The setting ``discretizer``: a name, a function, or a name and its options for each key of the observation."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

FUNCTION = "function"
MAPPING = "mapping"


def kind(discretizer: Any) -> str:
    """Returns the name of a discretizer, or ``"function"`` or ``"mapping"``."""
    if isinstance(discretizer, Mapping):
        return MAPPING
    return FUNCTION if callable(discretizer) else str(discretizer)


def uses_tiles(discretizer: Any) -> bool:
    """Whether a discretizer is, or contains, tile coding, so that no state has a row of its own."""
    if isinstance(discretizer, Mapping):
        names = (one.get("discretizer") if isinstance(one, Mapping) else one for one in discretizer.values())
        return any(isinstance(name, str) and name == "tiles" for name in names)
    return bool(discretizer == "tiles")


@dataclass(frozen=True)
class MissingFunction:
    """Placeholder for the function that was the discretizer of a saved run: files store only its name."""

    name: str

    def __call__(self, observation: Any) -> Any:  # noqa: ARG002
        """Raises an error that explains how to load the run with its function.

        Raises:
            ValueError: always.
        """
        raise ValueError(
            f"the run's discretizer is the function {self.name!r}, which a file cannot store: "
            "qtab.load(path, discretizer=...) restores it"
        )


def function_name(function: Callable[[Any], Any]) -> str:
    """Returns the name under which a saved run stores its function."""
    if isinstance(function, MissingFunction):
        return function.name
    return str(getattr(function, "__qualname__", type(function).__qualname__))


def stored_function(config: dict[str, Any]) -> dict[str, str]:
    """Removes a function from the fields of a config; returns its entry in a file, empty if there is no function."""
    function = config["discretizer"]
    if kind(function) != FUNCTION:
        return {}
    config["discretizer"] = None
    return {"discretizer_function": function_name(function)}

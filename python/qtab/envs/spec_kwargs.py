"""``wrappers`` and ``vector_kwargs`` of ``gymnasium.make_vec``, for ids with a vector entry point."""

from typing import Any

_PASSED_ON = ("vector_kwargs", "wrappers")
_DEFAULT_MODES = (None, "vector_entry_point")
_UNKNOWN = "unknown"


class SpecKwargs(dict[str, Any]):
    """The keyword arguments of a spec whose vector entry point takes ``wrappers`` and ``vector_kwargs``.

    ``gymnasium.make_vec`` pops both from the spec's keyword arguments, with its own arguments as defaults, and raises
    an error for them if it calls a vector entry point. Here they stay, so that they reach the entry point instead.
    With ``vectorization_mode="sync"`` or ``"async"``, and in all other respects, this is a plain dict.
    """

    _mode: Any = _UNKNOWN
    """The vectorization mode, which ``make_vec`` pops before these two."""

    def pop(self, key: str, *default: Any) -> Any:
        """Removes a key and returns its value; ``wrappers`` and ``vector_kwargs`` can stay."""
        value = super().pop(key, *default)
        if key == "vectorization_mode":
            self._mode = getattr(value, "value", value)
        elif key in _PASSED_ON and value and self._mode in _DEFAULT_MODES:
            self[key] = value
            return type(value)()
        return value

    def copy(self) -> "SpecKwargs":
        """Returns a copy, with which a spec makes the vector environment again."""
        return SpecKwargs(self)

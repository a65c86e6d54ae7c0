"""Error messages for observation spaces that a table cannot represent."""

from typing import Any

from gymnasium import spaces

from qtab._utils.shown import shown

FUNCTION = "a function as discretizer= with shape= or max_rows="


def refusal(space: Any, whole: Any, path: tuple[str | int, ...]) -> str:
    """Returns the reason why a table cannot represent a space, and a remedy.

    Args:
        space: The space.
        whole: The observation space that contains it, or ``space`` itself.
        path: The keys of the space in ``whole``.
    """
    where = f"under {path[0]!r}" if path else "at the top level"
    text = (
        f"the observation space must consist of numbers for a table, got {type(space).__name__} {where}: {shown(whole)}"
    )
    others = [key for key in whole.spaces if key != path[0]] if isinstance(whole, spaces.Dict) and path else []
    if others:
        return f"{text}; gymnasium.wrappers.FilterObservation(env, {others!r}) leaves it out, or give {FUNCTION}"
    if isinstance(space, spaces.Box):
        return f"{text}; gymnasium.wrappers.DtypeObservation(env, numpy.float64) converts it"
    return f"{text}; gymnasium.wrappers.TransformObservation converts it to numbers with a function, or give {FUNCTION}"


def too_large(parts: Any) -> str:
    """Returns a remedy for discrete spaces that are too large for a table, to be added to a message."""
    image = any(part.kind == "integer" and len(part.shape) in (2, 3) and part.size >= 64 for part in parts)
    if image:
        return (
            " (it holds an image: max_rows= assigns rows only to the images that are seen; "
            "gymnasium.wrappers.TransformObservation or a function as discretizer= with shape= reduces it)"
        )
    return (
        " (max_rows= assigns rows only to the observations that are seen; "
        "a function as discretizer= with shape= reduces their number)"
    )

"""What a vector environment of a class shows, besides the numbers that compiled code writes."""

import ast
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium import spaces

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.infos.dicts import KEY, info_of
from qtab.compilation.rewriting.program import Compiled, Program
from qtab.compilation.rewriting.source.syntax import own_name
from qtab.compilation.rewriting.values import Array, DictKind, Scalar, TupleKind, in_words


@dataclass(frozen=True, eq=False)
class Shown:
    """The info dicts and the types of observations of a class."""

    mask_dtype: str | None = None
    """The dtype of the action masks in the info dicts; None if these are empty."""
    refusal: NotCompilable | None = None
    """Why compiled code cannot give what a vector environment shows; None if it can."""
    other_dtype: NotCompilable | None = None
    """How observations differ in type from those of the space, to which a vector environment converts all but the last
    ones of episodes; None if they do not."""
    view: NotCompilable | None = None
    """Why the last observation of an episode changes at the next reset in Python: it is a view of an attribute that is
    changed in place. None if it does not."""


def shown_of(program: Program, methods: dict[str, Compiled], mask_refusal: NotCompilable | None) -> Shown:
    """Returns what a vector environment of a class shows.

    Args:
        program: The program of the class.
        methods: Its functions ``reset`` and ``step``.
        mask_refusal: Why its action mask cannot be compiled; None if it can, or without a mask.
    """
    try:
        mask_dtype = _mask_dtype(program, mask_refusal)
        if (left_out := program.refused_in_vectors()) is not None:
            raise left_out
        other_dtype = None
        for name, method in methods.items():
            kind: Any = method.result.kind.items[0]
            difference = _difference(program.env.observation_space, kind)
            line = next((at for text, at in reversed(method.lines) if text.strip().startswith("return") and at), None)
            if difference is not None:
                reason, fits = difference
                refusal = NotCompilable(f"{name} returns {reason}", method.file, line, "return the dtype of the space")
                if not fits:
                    raise refusal
                other_dtype = other_dtype or refusal
    except NotCompilable as refusal:
        return Shown(refusal=refusal)
    changed = program.attributes.changed_in_place
    view = next((refusal for names, refusal in program.shown_views if names & changed), None)
    return Shown(mask_dtype, None, other_dtype, view)


def _mask_dtype(program: Program, mask_refusal: NotCompilable | None) -> str | None:
    source, node, mask = info_of(program.attributes)
    if mask is None:
        return None
    if mask_refusal is not None:
        raise mask_refusal
    dtype, compiled = program.mask
    is_method = (
        isinstance(mask, ast.Call)
        and not (mask.args or mask.keywords)
        and ast.unparse(mask.func) == f"{own_name(source.node)}.action_masks"
    )
    if not (is_method if compiled is None else ast.dump(mask) == ast.dump(compiled)):
        advice = "write {'action_mask': self.action_masks()}"
        reason, line = f"info[{KEY!r}] is not what action_masks() returns", getattr(node, "lineno", None)
        raise NotCompilable(reason, source.file, line, advice)
    return dtype


def _difference(space: Any, kind: Any) -> tuple[str, bool] | None:
    """Returns how an observation differs in type from those of its space, and whether NumPy converts it to them.

    None if it does not differ.
    """
    if isinstance(space, spaces.Dict | spaces.Tuple):
        if isinstance(kind, DictKind):
            parts = [(space.spaces[key], item) for key, item in zip(kind.keys, kind.items, strict=True)]
        else:
            items = kind.items if isinstance(kind, TupleKind) else ()
            parts = list(zip(space.spaces, items, strict=True))
        found = [one for one in (_difference(*part) for part in parts) if one is not None]
        return min(found, key=lambda one: one[1], default=None)
    if isinstance(space, spaces.Discrete):
        is_integer = isinstance(kind, Scalar) and kind.name.startswith(("int", "uint"))
        return None if is_integer else (f"{in_words(kind)} for {space}", True)
    if isinstance(kind, Array):
        if np.dtype(kind.dtype) == space.dtype:
            return None
        return f"an array of {kind.dtype} for a space of {space.dtype}", np.can_cast(
            kind.dtype, space.dtype, "same_kind"
        )
    return f"{in_words(kind)} for {' '.join(str(space).split())}", True

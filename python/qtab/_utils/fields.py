"""Adds the docstrings of a dataclass's fields to its docstring, for ``help()``."""

import ast
import inspect
import textwrap
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from typing import Any, TypeVar

C = TypeVar("C", bound=type)


def with_fields(cls: C) -> C:
    """Adds a dataclass's fields to its docstring, and gives its constructor short annotations.

    The docstrings below fields are not part of a class at run time, and ``help()`` would spell an array's type in 70
    characters. The source is read on first use, because that takes milliseconds. Without the source, nothing changes.
    """
    init: Any = cls.__init__  # type: ignore[misc]
    annotations = init.__annotations__
    for name in annotations.keys() - {"return"}:
        annotations[name] = _Annotation(cls, name, annotations[name])
    cls.__doc__ = _Docstring(cls.__doc__ or "")  # type: ignore[assignment]
    return cls


class _Annotation:
    """An annotation, shown as written in the source."""

    def __init__(self, owner: type, name: str, type_: Any) -> None:
        self._owner, self._name, self._type = owner, name, type_

    def __repr__(self) -> str:
        for name, annotation, _ in source_fields(self._owner):
            if name == self._name:
                return annotation
        return inspect.formatannotation(self._type)


class _Docstring:
    """The docstring of a class, with its fields."""

    def __init__(self, text: str) -> None:
        self._text = text

    def __get__(self, instance: object, owner: type) -> str:
        entries = [
            textwrap.fill(f"{name} ({annotation}): {text}", 112, initial_indent=" " * 4, subsequent_indent=" " * 8)
            for name, annotation, text in source_fields(owner)
            if text
        ]
        if not entries:
            return self._text
        return "\n\n".join([inspect.cleandoc(self._text), "\n".join(["Attributes:", *entries]), ""])


@cache
def source_fields(cls: type) -> tuple[tuple[str, str, str], ...]:
    """Returns the name, the annotation and the docstring of each field, as in the source."""
    try:
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(cls))).body
    except (OSError, TypeError, SyntaxError):
        return ()
    return tuple(_read(tree))


def _read(tree: ast.stmt) -> Iterator[tuple[str, str, str]]:
    for statement, following in pairwise([*getattr(tree, "body", []), ast.Pass()]):
        if isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name):
            annotation = ast.unparse(statement.annotation).strip("'")
            match following:
                case ast.Expr(value=ast.Constant(value=str(text))):
                    yield statement.target.id, annotation, " ".join(text.split())
                case _:
                    yield statement.target.id, annotation, ""

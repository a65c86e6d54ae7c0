"""The docstrings of a dataclass's fields, where ``help()`` shows them."""

import ast
import inspect
import textwrap
from itertools import pairwise
from typing import Any, TypeVar

C = TypeVar("C", bound=type)


class _Annotation:
    """An annotation as it is written in the source."""

    def __init__(self, text: str) -> None:
        self._text = text

    def __repr__(self) -> str:
        return self._text


def with_fields(cls: C) -> C:
    """Ends the docstring of a dataclass with its fields, and gives its constructor short annotations.

    The docstrings below fields are no part of a class at run time, and ``help()`` would spell an array's type in 70
    characters. Without the source, nothing changes.
    """
    try:
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(cls))).body
    except (OSError, TypeError, SyntaxError):
        return cls
    written, lines = {}, []
    for statement, following in pairwise([*getattr(tree, "body", []), ast.Pass()]):
        if not isinstance(statement, ast.AnnAssign) or not isinstance(statement.target, ast.Name):
            continue
        name = statement.target.id
        written[name] = ast.unparse(statement.annotation).strip("'")
        match following:
            case ast.Expr(value=ast.Constant(value=str(text))):
                entry = f"{name} ({written[name]}): {' '.join(text.split())}"
                lines.append(textwrap.fill(entry, 112, initial_indent=" " * 4, subsequent_indent=" " * 8))
    cls.__doc__ = "\n\n".join([inspect.cleandoc(cls.__doc__ or ""), "\n".join(["Attributes:", *lines]), ""])
    init: Any = cls.__init__  # type: ignore[misc]
    signature = inspect.signature(init)
    parameters = [
        parameter.replace(annotation=_Annotation(written[name])) if name in written else parameter
        for name, parameter in signature.parameters.items()
    ]
    init.__signature__ = signature.replace(parameters=parameters)
    return cls

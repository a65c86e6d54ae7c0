"""Info dicts that a class changes: they must be its own, as compiled code leaves out the changes."""

import ast
from collections.abc import Iterator
from types import FunctionType

import gymnasium as gym

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.attributes import Attributes
from qtab.compilation.rewriting.infos.dicts import LENGTHS
from qtab.compilation.rewriting.infos.made import is_made, is_step, returned, values_of
from qtab.compilation.rewriting.program import Program
from qtab.compilation.rewriting.source.sources import Source, source_of
from qtab.compilation.rewriting.source.syntax import info_names

ADVICE = "make it here, as in {'cell': self.cell}"


def check_changed_infos(program: Program) -> None:
    """Refuses a class that changes info dicts, if it returns or takes one that it has not made.

    Other code may read such a dict, as one of the module, and compiled code would neither change it nor see the change.

    Raises:
        NotCompilable: with the line where it is taken or returned.
    """
    if not program.changes_infos:
        return
    attributes = program.attributes
    for source in _methods(attributes):
        assigned = [value for name in sorted(_names(source)) for value in values_of(source, name)]
        for node in [*assigned, *returned(source.node)]:
            if not is_made(attributes, source, node):
                line, text = getattr(node, "lineno", source.node.lineno), ast.unparse(node)
                raise NotCompilable(
                    f"an info dict is changed, and `{text}` was not made here", source.file, line, ADVICE
                )


def _methods(attributes: Attributes) -> Iterator[Source]:
    order = attributes.cls.__mro__
    for cls in order[: order.index(gym.Env)]:
        for role in LENGTHS:
            if isinstance(member := vars(cls).get(role), FunctionType):
                yield source_of(member)


def _names(source: Source) -> set[str]:
    """Returns the names of info dicts: those that are returned last, and those that a ``step`` or ``reset`` gives."""
    found = info_names(source.node)
    for one in ast.walk(source.node):
        if isinstance(one, ast.Assign) and any(
            isinstance(node, ast.expr) and is_step(node) for node in ast.walk(one.value)
        ):
            for target in one.targets:
                last = target.elts[-1] if isinstance(target, ast.Tuple | ast.List) else target
                if isinstance(last, ast.Name):
                    found.add(last.id)
    return found

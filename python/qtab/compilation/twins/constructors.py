"""The search for draws and effects in what makes an environment: whether each call makes the same one."""

import ast
from abc import ABCMeta
from types import FunctionType
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.attributes import MISSING
from qtab.compilation.rewriting.source.sources import Source
from qtab.compilation.rewriting.source.syntax import CHANGING
from qtab.compilation.twins.side_effects import Body, Search

ADVICE = "make the environment from its arguments only"
NEW = (ast.List, ast.Dict, ast.Set, ast.ListComp, ast.DictComp, ast.SetComp)
"""The expressions that make a new collection."""
MAKERS: tuple[Any, ...] = (
    *(list, dict, set, np.zeros, np.ones, np.full, np.empty, np.array, np.arange, np.zeros_like, np.ones_like),
)
"""The functions that make one, or a new array."""


def refuse_variation(make: Any, env: gym.Env) -> None:
    """Refuses a class, or a function, whose calls may make different environments, or may have effects.

    Args:
        make: The class of the environment, or a function that makes it.
        env: An environment that it has made, without wrappers. Nothing of it is run.

    Raises:
        NotCompilable: with the line, or if the source code is not available.
    """
    search = _Constructors(env)
    if isinstance(make, FunctionType):
        search.add(make, None, "")
    elif make is not type(env):
        raise NotCompilable(f"{getattr(make, '__name__', make)} makes the environment", advice=ADVICE)
    search.add_constructor()
    search.run()


class _Constructors(Search):
    """The functions that are called to make an environment."""

    def add_constructor(self) -> None:
        """Adds the constructor of the class.

        Raises:
            NotCompilable: if its objects are not made by an ordinary ``__init__``.
        """
        cls = type(self.env)
        if type(cls) not in (type, ABCMeta):
            raise NotCompilable(f"{cls.__name__} has a metaclass", advice=ADVICE)
        for base in cls.__mro__[: cls.__mro__.index(gym.Env)]:
            for name in ("__new__", "__setattr__", "__getattribute__", "__getattr__", "__set_name__"):
                if name in vars(base):
                    raise NotCompilable(f"{base.__name__} defines {name}", advice=ADVICE)
        member, owner = self.known.find("__init__")
        if isinstance(member, FunctionType):
            self.add(member, owner)
        elif owner is not object:
            raise NotCompilable(f"{cls.__name__} has no ordinary constructor", advice=ADVICE)

    def body(self, source: Source, owner: type | None, receiver: str) -> Body:
        """Returns the search in one of these functions."""
        return _Constructor(self, source, owner, receiver)


class _Constructor(Body):
    """The search in a function that is called to make an environment."""

    def _member(self, node: ast.Attribute, stores: bool) -> None:
        name = node.attr
        if name in ("np_random", "_np_random", "np_random_seed", "_np_random_seed"):
            raise self._refuse(node, "the constructor draws random numbers", "draw them in reset")
        member, owner = self._all.known.find(name, self._owner if self._is_super(node.value) else None)
        if name == "__init__" and owner in (object, gym.Env):
            return
        if stores and not isinstance(member, property):
            return
        super()._member(node, stores)

    def known_condition(self, node: ast.expr) -> Any:  # noqa: ARG002 - attributes have other values meanwhile
        """Returns ``MISSING``: both branches are searched."""
        return MISSING

    def _draws(self, node: ast.expr) -> bool:  # noqa: ARG002 - every draw is refused
        return False

    def _call(self, node: ast.Call) -> None:
        function = node.func
        if isinstance(function, ast.Attribute) and function.attr in CHANGING and not self._is_new(function.value):
            raise self._refuse(node, f"`{ast.unparse(function)}` may change a value that others use", ADVICE)
        super()._call(node)

    def _store(self, node: ast.Attribute | ast.Subscript) -> None:
        base: ast.expr = node
        while isinstance(base, ast.Subscript):
            base = base.value
        if base is not node and not self._is_new(base):
            raise self._refuse(node, f"`{ast.unparse(node)}` may change a value that others use", ADVICE)
        super()._store(node)

    def _callable(self, node: ast.AST, value: Any) -> None:
        if isinstance(value, type):
            is_space = issubclass(value, spaces.Space) and value.__module__.partition(".")[0] == "gymnasium"
            if is_space or value in (type(self._all.env), gym.wrappers.TimeLimit):
                return
        super()._callable(node, value)

    def _is_new(self, node: ast.expr) -> bool:
        """Returns whether a variable or an attribute only ever holds collections or arrays that the function makes."""
        text = ast.unparse(node)
        values: list[ast.expr | None] = []
        for one in ast.walk(self._source.node):
            targets = one.targets if isinstance(one, ast.Assign) else []
            targets = [one.target] if isinstance(one, ast.AnnAssign) else targets
            for target in targets:
                if ast.unparse(target) == text:
                    values.append(one.value)  # type: ignore[attr-defined]
                elif any(ast.unparse(part) == text for part in ast.walk(target) if isinstance(part, ast.Name)):
                    return False
        return bool(values) and all(self._makes(value) for value in values)

    def _makes(self, value: ast.expr | None) -> bool:
        if not isinstance(value, ast.Call):
            return isinstance(value, NEW)
        made = self.value(value.func)
        return made in MAKERS if made is not MISSING and callable(made) else False

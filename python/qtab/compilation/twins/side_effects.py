"""The search for effects of an environment's methods outside of it, by their source code: nothing is run."""

import ast
import builtins
import dataclasses
import sys
from types import BuiltinFunctionType, FunctionType, ModuleType
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.attributes import MISSING, Attributes
from qtab.compilation.rewriting.expressions.calls import MODULE_ADVICE, SIDE_EFFECTS
from qtab.compilation.rewriting.source.sources import Source, source_of
from qtab.compilation.rewriting.source.syntax import CHANGING
from qtab.compilation.rewriting.statements.effects import PURE_BUILTINS, PURE_METHODS, UNSAFE_NUMPY
from qtab.compilation.twins.known_values import KnownValues
from qtab.compilation.twins.plain_data import is_plain, mutable_parts

METHODS = ("reset", "step", "action_masks", "action_mask")
"""The methods that are run in Python before they are compiled."""
SAFE_BUILTINS = {
    *(*PURE_BUILTINS, "bytes", "chr", "complex", "format", "hash", "issubclass", "iter", "next", "ord", "slice"),
}
SAFE_METHODS = {
    *(*CHANGING, *PURE_METHODS, "contains", "cumsum", "difference", "dot", "endswith", "intersection", "isdigit"),
    *("isspace", "nonzero", "prod", "replace", "rotate", "searchsorted", "split", "squeeze", "startswith", "strip"),
    *("transpose", "union", "var"),
}
"""The methods of numbers, texts, arrays and collections."""
REFUSED: tuple[type[ast.AST], ...] = (
    *(ast.With, ast.AsyncWith, ast.AsyncFor, ast.Await, ast.Yield, ast.YieldFrom, ast.Try, ast.ClassDef),
    *(ast.Global, ast.Nonlocal, ast.Delete, ast.FunctionDef, ast.AsyncFunctionDef, getattr(ast, "TryStar", ast.Try)),
)
"""The syntax that is not compiled and may have effects."""
ADVICE = "use numbers, math, and the NumPy functions of the documentation"


def refuse_effects(env: gym.Env) -> list[Any]:
    """Refuses an environment whose resets or steps may have effects outside of it, such as files, prints or windows.

    Args:
        env: The environment, without wrappers. Nothing of it is run.

    Returns:
        The lists, dicts, sets, deques and arrays that its methods read: of its class, of modules, of default arguments.

    Raises:
        NotCompilable: if they may, with the line, or if the source code is not available.
    """
    if (base := next((one for one in type(env).__mro__ if "__del__" in vars(one)), None)) is not None:
        raise NotCompilable(f"{base.__name__} defines __del__, which would be called for a copy", advice="use close")
    search = _Search(env)
    for name in METHODS:
        member, owner = search.known.find(name)
        if isinstance(member, FunctionType):
            search.add(member, owner)
    search.run()
    return list(search.shared.values())


class _Search:
    """The functions of an environment that are reached, and what is known about it."""

    def __init__(self, env: gym.Env) -> None:
        self.env = env
        self.known = Attributes(env, env)
        self.shared: dict[int, Any] = {}
        self._waiting: list[tuple[FunctionType, type | None, str]] = []
        self._found: set[tuple[FunctionType, type | None, str]] = set()

    def add(self, function: FunctionType, owner: type | None, receiver: str = "self") -> None:
        """Adds a function that is called.

        Args:
            function: The function.
            owner: The class that defines it; None if it is no method.
            receiver: ``"self"`` or ``"class"`` if its first argument is the environment or its class, else ``""``.
        """
        one = (function, owner, receiver)
        if one not in self._found:
            self._found.add(one)
            self._waiting.append(one)

    def run(self) -> None:
        """Searches all functions that are reached."""
        while self._waiting:
            function, owner, receiver = self._waiting.pop()
            _Body(self, source_of(function), owner, receiver).search()


class _Body(KnownValues):
    """The search in the body of a function."""

    def __init__(self, search: _Search, source: Source, owner: type | None, receiver: str) -> None:
        super().__init__(search.env, search.known, source, receiver)
        self._all, self._source, self._owner = search, source, owner

    def search(self) -> None:
        """Searches the function.

        Raises:
            NotCompilable: for the first statement that may have effects.
        """
        function = self._source.function
        for default in (*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values()):
            self._data(self._source.node, default)
        for statement in self._source.node.body:
            self._visit(statement)

    def _refuse(self, node: ast.AST, reason: str, advice: str = ADVICE) -> NotCompilable:
        return NotCompilable(reason, self._source.file, getattr(node, "lineno", self._source.node.lineno), advice)

    def _visit(self, node: ast.AST) -> None:
        if isinstance(node, REFUSED):
            raise self._refuse(node, f"`{ast.unparse(node).splitlines()[0]}` may have effects", "write conditions")
        if isinstance(node, ast.If | ast.IfExp) and isinstance(taken := self.known_condition(node.test), bool):
            chosen = node.body if taken else node.orelse
            for one in chosen if isinstance(chosen, list) else [chosen]:
                self._visit(one)
            return
        if isinstance(node, ast.Import | ast.ImportFrom):
            self._import(node)
        elif isinstance(node, ast.AnnAssign):
            for part in (node.target, node.value):
                if part is not None:
                    self._visit(part)
        elif isinstance(node, ast.Call):
            self._call(node)
        elif isinstance(node, ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store):
            self._store(node)
        elif isinstance(node, ast.Attribute | ast.Name):
            self._load(node)
        else:
            for child in ast.iter_child_nodes(node):
                if not isinstance(child, ast.expr_context):
                    self._visit(child)

    def _import(self, node: ast.Import | ast.ImportFrom) -> None:
        for alias in node.names:
            name = alias.name if isinstance(node, ast.Import) else node.module or ""
            module = sys.modules.get(name)
            if module is None or (isinstance(node, ast.ImportFrom) and node.level):
                raise self._refuse(node, f"`{ast.unparse(node)}` runs a module", "import it at the top of the file")
            value = module if isinstance(node, ast.Import) else getattr(module, alias.name, MISSING)
            self.imported[alias.asname or alias.name.partition(".")[0]] = value

    def _store(self, node: ast.Attribute | ast.Subscript) -> None:
        """Checks an assignment: to the environment, or to an element of its data or of a local variable."""
        base: ast.expr = node
        while isinstance(base, ast.Subscript):
            self._visit(base.slice)
            base = base.value
        if isinstance(base, ast.Attribute) and self.is_own(base.value):
            self._load(ast.Attribute(base.value, base.attr, ast.Load(), lineno=node.lineno), stores=base is node)
        elif base is node or not (isinstance(base, ast.Name) and self.names.is_local(base.id)):
            raise self._refuse(node, f"`{ast.unparse(node)}` is assigned", "change only attributes of self")

    def _load(self, node: ast.Attribute | ast.Name, stores: bool = False) -> None:
        """Checks a value that is read: it must be data, or a function without effects."""
        if isinstance(node, ast.Attribute):
            if self.is_own(node.value) or self._is_super(node.value):
                self._member(node, stores)
                return
            if self.value(node.value) is MISSING:
                self._visit(node.value)
                return
        elif self.is_own(node):
            raise self._refuse(node, "self is passed on", "use self directly in the environment's methods")
        value = self.value(node)
        if value is MISSING:
            if isinstance(node, ast.Attribute):
                raise self._refuse(
                    node, f"the attribute `{ast.unparse(node)}` is no data", "copy it to self in __init__"
                )
            return
        self._data(node, value)

    def _is_super(self, node: ast.expr) -> bool:
        return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "super"

    def _member(self, node: ast.Attribute, stores: bool) -> None:
        """Checks an attribute of the environment."""
        known, name = self._all.known, node.attr
        if name.startswith("__") and not name.endswith("__"):
            raise self._refuse(node, f"self.{name} is a private name", f"name it self.{name[1:]}")
        member, owner = known.find(name, self._owner if self._is_super(node.value) else None)
        if name in ("np_random", "_np_random", "unwrapped", "np_random_seed") and owner is gym.Env:
            return
        if isinstance(member, property):
            if stores or not isinstance(member.fget, FunctionType):
                raise self._refuse(node, f"self.{name} is a property", "use an ordinary attribute")
            self._all.add(member.fget, owner)
        elif isinstance(member, FunctionType):
            if member is not gym.Env.reset:
                self._all.add(member, owner)
        elif isinstance(member, staticmethod | classmethod):
            if isinstance(member.__func__, FunctionType):
                self._all.add(member.__func__, owner, "class" if isinstance(member, classmethod) else "")
        elif hasattr(type(member), "__get__") or hasattr(type(member), "__set__"):
            raise self._refuse(node, f"self.{name} is a descriptor of its class", "use an ordinary attribute")
        elif not stores and name in vars(self._all.env):
            self._data(node, vars(self._all.env)[name], is_copied=True)
        elif not stores and member is not MISSING:
            self._data(node, member)

    def _data(self, node: ast.AST, value: Any, is_copied: bool = False) -> None:
        """Checks a value that is no local variable; ``is_copied`` if it is an attribute that a copy has of its own."""
        if isinstance(value, FunctionType | type) or callable(value):
            self._callable(node, value)
        elif not isinstance(value, ModuleType) and not is_plain(value):
            what = f"`{ast.unparse(node)}`" if isinstance(node, ast.expr) else "a default argument"
            raise self._refuse(node, f"{what} is an object of type {type(value).__name__}", "use numbers and arrays")
        elif not is_copied and not isinstance(value, ModuleType):
            self._all.shared.update((id(part), part) for part in mutable_parts(value))

    def _call(self, node: ast.Call) -> None:
        function, passes_self = node.func, self._is_super(node)
        if (
            isinstance(function, ast.Attribute)
            and not self.is_own(function.value)
            and not self._is_super(function.value)
        ):
            value, owner = self.value(function), self.value(function.value)
            if isinstance(value, FunctionType) and isinstance(owner, type) and isinstance(self._all.env, owner):
                passes_self = True  # Base.method(self, ...)
                if value is not gym.Env.reset:
                    self._all.add(value, next(one for one in owner.__mro__ if function.attr in vars(one)))
            elif isinstance(value, FunctionType | type) or (owner is not MISSING and not is_plain(owner)):
                self._load(function)
            elif not self._draws(function.value):
                self._method(node, function)
        elif isinstance(function, ast.Name) and self.names.is_local(function.id) and function.id not in self.imported:
            raise self._refuse(node, f"{function.id} is called, a variable", "call functions by name")
        elif not isinstance(function, ast.Name | ast.Attribute):
            raise self._refuse(node, f"`{ast.unparse(function)}` is called", "call functions by name")
        elif not self._is_super(node):
            self._visit(function)
        for argument in (*node.args, *[keyword.value for keyword in node.keywords]):
            if not (passes_self and self.is_own(argument)):
                self._visit(argument)

    def _draws(self, node: ast.expr) -> bool:
        return isinstance(node, ast.Attribute) and node.attr == "np_random" and self.is_own(node.value)

    def _method(self, node: ast.Call, function: ast.Attribute) -> None:
        """Checks the call of a method of data."""
        owner = self.value(function.value)
        if isinstance(owner, spaces.Space) and function.attr != "contains":
            raise self._refuse(node, "a space has a random generator of its own", "draw from self.np_random")
        if isinstance(owner, np.random.Generator):
            raise self._refuse(node, "a second random generator", "draw from self.np_random")
        if function.attr not in SAFE_METHODS or dataclasses.is_dataclass(owner):
            raise self._refuse(node, f"`{ast.unparse(function)}` is called")
        self._visit(function.value)

    def _callable(self, node: ast.AST, value: Any) -> None:
        """Checks a function or a class that is used."""
        name, module = getattr(value, "__name__", type(value).__name__), str(getattr(value, "__module__", None) or "")
        root = module.partition(".")[0]
        if getattr(builtins, name, None) is value and (name in SAFE_BUILTINS or isinstance(value, type)):
            return
        if value is gym.Env.reset or module in ("math", "gymnasium.logger") or value is super:
            return
        if root == "numpy" and isinstance(
            getattr(value, "__self__", None), np.random.Generator | np.random.RandomState
        ):
            raise self._refuse(node, *MODULE_ADVICE["numpy.random"])
        if (isinstance(value, np.ufunc) or root == "numpy") and "random" not in module:
            if not name.startswith(UNSAFE_NUMPY):
                return
        elif isinstance(value, type):
            if issubclass(value, BaseException) and isinstance(value.__init__, type(object.__init__)):
                return
            if hasattr(value, "__members__") or hasattr(value, "_fields") or module == "collections":
                return
            is_record = dataclasses.is_dataclass(value) and not hasattr(value, "__post_init__")
            if is_record and all(one.default_factory is dataclasses.MISSING for one in dataclasses.fields(value)):
                return
            raise self._refuse(node, f"an object of type {name} is made", "use numbers, tuples and NumPy arrays")
        elif isinstance(value, FunctionType) and root not in sys.stdlib_module_names - {"__main__"}:
            self._all.add(value, None, "")
            return
        if isinstance(value, BuiltinFunctionType) and value in SIDE_EFFECTS:
            raise self._refuse(node, *SIDE_EFFECTS[value])
        for prefix, (reason, advice) in MODULE_ADVICE.items():
            if module == prefix or module.startswith(prefix + "."):
                raise self._refuse(node, reason, advice)
        if type(getattr(value, "__self__", None)).__module__ == "random":
            raise self._refuse(node, *MODULE_ADVICE["random"])
        raise self._refuse(node, f"{name} is called")

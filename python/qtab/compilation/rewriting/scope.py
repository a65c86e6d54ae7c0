"""The names of a function that is rewritten, and its errors."""

import ast
import re
from types import FunctionType

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.program import Compiled, Flow, Program
from qtab.compilation.rewriting.source.sources import Source
from qtab.compilation.rewriting.source.syntax import Names
from qtab.compilation.rewriting.values import INFO, Array, Kind, Scalar, Value, in_words, join

MAX_SHOWN = 90
LOCAL = "local variable "
"""The beginning of the entries of local variables in a flow."""


class Scope:
    """The state of rewriting one function.

    Args:
        program: The program that the function becomes a part of.
        source: The function.
        owner: The class that defines it; None for a function of a module.
        parameters: The value of each parameter.
        compiled: The function in the program.
        role: ``reset``, ``step`` or ``mask`` if it is that method of the environment, else empty.
    """

    def __init__(
        self,
        program: Program,
        source: Source,
        owner: type | None,
        parameters: dict[str, Value],
        compiled: Compiled,
        role: str,
    ) -> None:
        self.program, self.source, self.owner, self.role = program, source, owner, role
        self.compiled = compiled
        self.names = Names(source)
        self.parameters = parameters
        self.kinds: dict[str, Kind] = {}
        self.fixed: dict[str, Value] = {}
        self.versions: dict[str, str] = {}
        self.views: dict[str, frozenset[str]] = {}
        """The attributes whose memory each local variable shares in Python."""
        self.owned: dict[str, bool] = {}
        """Whether each local array was made by the function, so that no other name refers to it."""
        self.dynamic: set[str] = set()
        """The local names that cannot hold constants, as branches assign them."""
        self.actions: set[str] = set()
        """The names that hold the action that ``step`` was given."""
        self.lines: list[tuple[str, int]] = []
        self.indent = 1
        self.flow = Flow()
        self.flows_at_exit: list[tuple[list[set[str]], list[set[str]]]] = []
        """For each loop around the statement, what is assigned at each `break` and at each `continue`."""
        self.flows_at_return: list[set[str]] = []
        """The attributes that are assigned where the function returns."""
        self.depth = 0
        """How many branches and loops that are decided at run time are around the statement."""
        self.temporaries = 0
        self.unstable = False
        self.copies_state = False
        """Whether arrays of the record are copied where they are read, as the statement may change them."""
        self.references: list[tuple[ast.expr, frozenset[str]]] = []
        """The arrays and lists that the statement reads, which are references in Python, with their attributes."""
        self.changing: list[ast.AST] = []
        """The calls in the statement that change the state."""
        self.called: list[Compiled] = []
        """The user's functions that this function calls, in order."""
        self.unknown: set[str] = set()
        """The local variables that statements assign which cannot be compiled."""
        self.whole: ast.expr | None = None
        """The expression that is all of a statement, or all of what a statement assigns or returns."""
        self.shared: set[str] = set()
        """The attributes that a statement assigns, and whose values may be objects with other names."""

    @property
    def function(self) -> FunctionType:
        """The function."""
        return self.source.function

    def refuse(self, node: ast.AST | None, reason: str, advice: str) -> NotCompilable:
        """Returns the error for code that cannot be compiled."""
        if node is None or not hasattr(node, "lineno"):
            node = self.source.node
            return NotCompilable(reason, self.source.file, node.lineno, advice)
        text = ast.unparse(node).splitlines()[0]
        shown = text if len(text) <= MAX_SHOWN else text[: MAX_SHOWN - 3] + "..."
        return NotCompilable(f"{reason} in `{shown}`", self.source.file, node.lineno, advice)

    def has_effects(self, value: Value) -> bool:
        """Returns whether the code of a value must be evaluated: it may change the state or draw random numbers.

        A function whose result is a constant is called as well, since it may raise an error.
        """
        found = [self.program.named.get(name) for name in re.findall(r"\bf_\d+_\w+", value.code)]
        called = [one for one in found if one is not None]
        return "rng." in value.code or any(one.changes or one.draws or one.result.is_fixed for one in called)

    def no_effects(self, value: Value, node: ast.AST, reason: str = "a call whose result is not used") -> None:
        """Refuses a value whose code is left out, evaluated under a condition, or moved, if it has effects."""
        if self.has_effects(value):
            raise self.refuse(node, reason, "assign it to a variable first")

    def local(self, name: str) -> Value:
        """Returns a local variable."""
        version = self.version(name)
        views = self.views.get(version, frozenset())
        return Value(self.kinds[version], version, action=name in self.actions, views=views)

    def version(self, name: str) -> str:
        """Returns the variable of the program that holds a local variable now."""
        return self.versions.get(name, f"v_{name}")

    def new_version(self, name: str, kind: Kind) -> None:
        """Uses another variable of the program for a local variable that changes its type between statements."""
        before = self.kinds.get(self.version(name))
        if before is not None and before != kind and self.depth == 0:
            count = int(self.version(name).partition("_")[0][1:] or 0) + 1
            self.versions[name] = f"v{count}_{name}"

    def note_kind(self, name: str, kind: Kind, node: ast.AST) -> None:
        """Notes the kind of a value that is assigned to a local variable."""
        version = self.version(name)
        before = self.kinds.get(version)
        if before is None:
            self.kinds[version] = kind
            return
        joined = join(before, kind)
        if joined is None:
            reason = f"the variable {name} is {in_words(before)}, and later {in_words(kind)}"
            raise self.refuse(node, reason, "use one variable for each type")
        if joined != before:
            self.kinds[version] = joined
            self.unstable = True

    def mark_array(self, name: str, value: Value) -> None:
        """Notes whether an array that is assigned to a local variable has no other name."""
        if isinstance(value.kind, Array):
            version = self.version(name)
            self.owned[version] = self.owned.get(version, True) and value.fresh and not value.views

    def note_set(self, name: str) -> None:
        """Notes that a local variable is set from here on."""
        self.flow.assigned.add(f"{LOCAL}{name}")

    def is_set(self, name: str) -> bool:
        """Returns whether a local variable is set on every path to this statement."""
        return f"{LOCAL}{name}" in self.flow.assigned

    def note_alias(self, value: Value, node: ast.AST, compiled: Compiled | None = None) -> None:
        """Notes that a variable, or a parameter of a called function, shares memory with attributes in Python."""
        if value.views:
            names = " and ".join(f"self.{name}" for name in sorted(value.views))
            reason, advice = f"a variable shares the memory of {names}, which is changed in place", "write .copy()"
            self.program.aliases.append(
                (compiled or self.compiled, value.views, lambda: self.refuse(node, reason, advice))
            )

    def is_owned(self, name: str) -> bool:
        """Returns whether no other name refers to a local array that was made by the function."""
        return self.owned.get(self.version(name), False)

    def kind_of_local(self, name: str) -> Kind | None:
        """Returns the kind of a local variable; None if it is not set."""
        return self.kinds.get(self.version(name))

    def element(self, value: Value, index: int) -> Value:
        """Returns an element of a tuple, of which the code is evaluated once for each element."""
        if value.parts is not None:
            return value.parts[index]
        items = value.kind.items
        kind = items[index]
        if kind == INFO:
            return Value(INFO)
        position = index - sum(one == INFO for one in items[:index])
        views = frozenset[str]() if isinstance(kind, Scalar) else value.views
        return Value(kind, f"{value.code}[{position}]", views=views)

    def emit(self, text: str, node: ast.AST | None = None) -> None:
        """Adds a line to the function."""
        self.lines.append(("    " * self.indent + text, getattr(node, "lineno", 0)))

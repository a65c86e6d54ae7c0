"""The program that a class becomes: its functions, constants and lines."""

import ast
from collections.abc import Callable
from dataclasses import dataclass, field
from types import FunctionType
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.attributes import Attributes
from qtab.compilation.rewriting.values import (
    FLOAT,
    INT,
    MIXED,
    WIDE,
    Array,
    DictKind,
    Kind,
    Scalar,
    TupleKind,
    Value,
    is_immutable,
    kind_of,
)

MAX_INLINE = 64
"""The most elements of a constant array that are written as numbers; larger ones are bytes."""
MAX_BYTES = 1 << 24
"""The most bytes of a constant array."""

STALE = "stale attribute "
"""The beginning of the entries in a flow of attributes that are assigned and never read."""


@dataclass
class Compiled:
    """A function of the program."""

    name: str
    result: Value
    """What it returns: a constant, or a kind."""
    lines: list[tuple[str, int]] = field(default_factory=list)
    """Its lines, and the lines of the user's file."""
    file: str = ""
    """The user's file; empty for functions that are not the user's."""
    uses: set[str] = field(default_factory=set)
    """The names of functions that it calls."""
    draws: bool = False
    """Whether it draws random numbers."""
    changes: bool = False
    """Whether it changes the state."""
    trivial: bool = False
    """Whether it only returns."""
    returns_parameter: bool = False
    """Whether an array that it returns may share the memory of a parameter in Python."""
    flow: "Flow" = field(default_factory=lambda: Flow())
    """The attributes that it assigns and reads."""


@dataclass
class Flow:
    """The attributes that a function assigns and reads, in the order of its statements."""

    assigned: set[str] = field(default_factory=set)
    """The attributes that it assigns on every path."""
    read: set[str] = field(default_factory=set)
    """The attributes that it may read before it assigns them."""

    def note_read(self, name: str) -> None:
        """Notes that an attribute is read."""
        if name not in self.assigned:
            self.read.add(name)

    def follow(self, other: "Flow") -> None:
        """Notes what a called function does."""
        for name in other.read:
            self.note_read(name)
        self.assigned |= other.assigned


class Program:
    """The functions and constants of one attempt to rewrite a class."""

    def __init__(self, env: gym.Env, attributes: Attributes) -> None:
        self.env, self.attributes = env, attributes
        self.functions: dict[Any, Compiled | None] = {}
        self.constants: dict[Any, tuple[str, str]] = {}
        self.named: dict[str, Compiled] = {}
        self._kept: list[Any] = []  # keeps the objects in keys alive, so that no other gets the id of one
        self.phase = "reset"
        """Which function is rewritten: ``reset``, ``step`` or ``mask``."""
        self.seeded = False
        """Whether ``reset`` has called that of ``gymnasium.Env``."""
        self.depth = 0
        """How many branches and loops that are decided at run time are around the code."""
        self.aliases: list[tuple[Compiled, frozenset[str], Callable[[], Exception]]] = []
        """The variables that share memory with attributes, with their functions, and the errors if it matters."""
        self.stored: set[str] = set()
        """The attributes that functions assign."""
        self.compile_call: Callable[..., Value]
        """Compiles a user's function and returns the value of a call."""
        self.infos: dict[str, list[Any]] = {}
        """The info dicts that ``reset`` and ``step`` return, with their functions."""
        self.changes_infos = False
        """Whether a statement changes an info dict."""
        self.left_out: list[NotCompilable] = []
        """The errors, for vector environments, for code that is left out and that may fail or log messages."""
        self.stale_kinds: dict[str, set[Kind | None]] = {}
        """The kinds of what is assigned to attributes that are never read; None for other values than numbers."""
        self.changed_stale: list[tuple[str, Scalar | None, NotCompilable]] = []
        """Augmented assignments to such attributes: the name, the kind of the number, and the error for others."""
        self.stale_objects: set[str] = set()
        """The attributes that are never read and may hold a list, an array or another object with another name."""
        self.stale: dict[str, NotCompilable] = {}
        """The attributes that are assigned and never read, and the errors for those that reset does not assign."""
        self.stale_in_reset: set[str] | None = None
        """Those of them that ``reset`` always assigns; None before that is known."""
        self.shown_views: list[tuple[frozenset[str], NotCompilable]] = []
        """The attributes whose memory observations share in Python, and the errors if it is shown that they change."""
        self.mask: tuple[str, ast.expr | None] = "", None
        """The dtype of the compiled action mask, and its expression in the info dicts; None for a method."""
        self.failed: set[Any] = set()
        """The keys of functions that cannot be compiled."""
        self.problems: list[NotCompilable] = []
        """What cannot be compiled, in ``reset``, ``step`` and the functions that they call."""

    def refused_in_vectors(self) -> NotCompilable | None:
        """Returns the error for code that is left out, and whose effect a vector environment would show."""
        changed = [
            error
            for name, kind, error in self.changed_stale
            if not self.stale_kinds.get(name, set()) <= ({kind, INT, FLOAT, MIXED} if kind in WIDE else {kind})
        ]
        kept = [error for name, error in self.stale.items() if name not in (self.stale_in_reset or ())]
        return next(iter([*self.left_out, *changed, *kept]), None)

    def changed_objects(self) -> list[str]:
        """Returns the attributes that are never read, but whose augmented assignments may change another object."""
        names = {name for name, _, _ in self.changed_stale}
        kept = names - (self.stale_in_reset or set())
        known = self.attributes
        before = {name: vars(known.env).get(name, known.find(name)[0]) for name in kept}
        return sorted(names & self.stale_objects | {name for name, value in before.items() if not is_immutable(value)})

    def key(self, function: FunctionType, owner: type | None, values: dict[str, Value]) -> Any:
        """Returns the key of a function that is called with given constants and kinds."""
        self._kept.append((function, values))
        return function, owner, tuple((name, self._value_key(value)) for name, value in values.items())

    def _value_key(self, value: Value) -> Any:
        if not value.is_fixed:
            return value.kind, value.action
        if isinstance(value.fixed, bool | int | float | str | type(None)):
            return type(value.fixed), repr(value.fixed)
        return "object", id(value.fixed)

    def new_name(self, wanted: str) -> str:
        """Returns a new name for a function."""
        name = f"f_{len(self.named)}_{wanted}"
        self.named[name] = Compiled(name, Value())
        return name

    def add(self, name: str, lines: list[str], **known: Any) -> str:
        """Adds a function that is not the user's, such as a lookup in a constant table."""
        self.named[name] = Compiled(name, Value(), [(line, 0) for line in lines], **known)
        return name

    def elements(self, count: int, scalar: Scalar) -> str:
        """Returns the name of a function that returns the elements of a vector as a tuple."""
        name = f"t_{count}_{scalar.name}"
        if name not in self.named:
            items = ", ".join(converted(f"a[{i}]", scalar) for i in range(count))
            self.add(
                name,
                [f"def {name}(a):", f"    if a.size != {count}:", "        raise ValueError", f"    return ({items},)"],
            )
        return name

    def array(self, value: np.ndarray[Any, Any]) -> str:
        """Returns the name of a constant array."""
        key = value.dtype.str, value.shape, value.tobytes()
        if key not in self.constants:
            dtype = f"np.dtype({value.dtype.str!r})"
            if value.size <= MAX_INLINE and not np.any(np.isnan(value) | np.isinf(value)):
                code = f"np.array({value.tolist()!r}, dtype={dtype})"
            else:
                shape = value.shape
                code = f"np.frombuffer(bytes.fromhex({value.tobytes().hex()!r}), dtype={dtype}).reshape({shape}).copy()"
            self.constants[key] = f"c_{len(self.constants)}", code
        return self.constants[key][0]

    def lift(self, value: Value, refuse: Callable[[str, str], Exception]) -> Value:
        """Returns a constant as code."""
        if not value.is_fixed:
            return value
        fixed = value.fixed
        kind = kind_of(fixed)
        if isinstance(kind, Scalar):
            return Value(kind, literal(fixed), fixed=value.fixed)
        if isinstance(kind, Array):
            if fixed.nbytes > MAX_BYTES:
                reason = f"a constant array takes {fixed.nbytes / 2**20:,.0f} MiB, more than {MAX_BYTES // 2**20}"
                raise refuse(reason, "use a smaller dtype, or compute its elements")
            return Value(kind, self.array(fixed), fixed=value.fixed)
        if isinstance(fixed, tuple | list):
            parts = tuple(self.lift(Value(fixed=part), refuse) for part in fixed)
            return tuple_value(parts)
        if type(fixed) is dict and all(isinstance(key, str) for key in fixed):
            made = tuple_value(tuple(self.lift(Value(fixed=part), refuse) for part in fixed.values()))
            return Value(DictKind(tuple(fixed), made.kind.items), made.code, parts=made.parts)
        if fixed is None:
            raise refuse("None is used as a value", "use a number for 'none', such as -1 or math.nan")
        if isinstance(fixed, str | bytes):
            raise refuse("a string is used as a value", "number the choices: use an integer")
        if isinstance(fixed, int):
            raise refuse(f"the integer {fixed} has more than 64 bits", "use smaller integers or floats")
        kind_name = type(fixed).__name__
        raise refuse(f"an object of type {kind_name} is used as a value", "use numbers, tuples and NumPy arrays")

    def check_aliases(self) -> None:
        """Refuses variables that would show changes of an attribute in Python, and do not in compiled code."""
        for compiled, names, error in self.aliases:
            if compiled.changes and names & self.attributes.changed_in_place:
                raise error()

    def source(self, tops: list[str]) -> tuple[str, dict[int, tuple[str, int]]]:
        """Returns the program that the named functions need, and the user's lines of its lines."""
        needed: list[str] = []
        waiting = list(tops)
        while waiting:
            name = waiting.pop()
            if name not in needed and name in self.named:
                needed.append(name)
                waiting += sorted(self.named[name].uses)
        text = ["import math", "import numpy as np"]
        body = [line for name in sorted(needed) for line, _ in self.named[name].lines]
        used = "\n".join(body)
        text += [f"{name} = {code}" for name, code in self.constants.values() if name in used]
        lines: dict[int, tuple[str, int]] = {}
        for name in sorted(needed):
            text += ["", ""] if self.named[name].lines else []
            for line, origin in self.named[name].lines:
                text.append(line)
                if origin:
                    lines[len(text)] = self.named[name].file, origin
        return "\n".join(text) + "\n", lines


def literal(value: Any) -> str:
    """Returns the code of a number."""
    if isinstance(value, bool | np.bool_):
        return repr(bool(value))
    if isinstance(value, int | np.int64):
        if value == -(2**63):  # Numba takes it for a number without a sign
            return "(-9223372036854775807 + np.int64(-1))"
        return repr(int(value)) if value >= 0 else f"({int(value)!r})"
    if isinstance(value, np.generic) and not isinstance(value, np.float64):
        return f"np.{value.dtype.name}({literal(value.item())})"
    number = float(value)
    if number != number:
        return "math.nan"
    if number in (float("inf"), float("-inf")):
        return "math.inf" if number > 0 else "(-math.inf)"
    return repr(number) if str(number)[0] != "-" else f"({number!r})"


def converted(code: str, scalar: Scalar) -> str:
    """Returns code that reads a number from an array or a record as Python's or NumPy's type."""
    names = {"bool": "bool", "int": "int", "float": "float", "mixed": "float"}
    return f"{names[scalar.name]}({code})" if scalar.name in names else code


def as_float(value: Value) -> str:
    """Returns the code of a number as a float; ``float`` of a boolean cannot be compiled."""
    if value.kind == Scalar("bool"):
        return f"(1.0 if {value.code} else 0.0)"
    return value.code if value.kind == Scalar("float") else f"float({value.code})"


def tuple_value(parts: tuple[Value, ...]) -> Value:
    """Returns a tuple that is written out; info dicts have no code."""
    code = ", ".join(part.code for part in parts if part.code)
    return Value(
        TupleKind(tuple(part.kind for part in parts)),
        f"({code},)" if code else "()",
        parts=parts,
        views=frozenset().union(*(part.views for part in parts)),
    )

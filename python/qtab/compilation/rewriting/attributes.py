"""The attributes of the environment: which are state, which are constant, and the fields of the record."""

import ast
import enum
import inspect
from collections.abc import Callable, Iterator, Mapping
from types import FunctionType
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting.source.sources import source_of
from qtab.compilation.rewriting.source.syntax import CHANGING, growing_lists, new_lists, own_name
from qtab.compilation.rewriting.values import Array, Kind, Scalar, TupleKind, in_words, join, kind_of

Refuse = Callable[[str, str], NotCompilable]
MISSING = object()
NOT_STEPPING = ("render", "close", "__init__")
LIBRARY = ("gymnasium", "typing", "abc", "builtins")


class Restart(Exception):  # noqa: N818
    """More is known about the attributes: the class is rewritten again."""


class Attributes:
    """What is known about the attributes of an environment.

    Args:
        env: The environment, from which constants are read.
        twin: A copy of it that was reset, from which the kinds of the other attributes are read.
        sharing: The attributes that share memory before they were copied, and what with.
    """

    def __init__(self, env: gym.Env, twin: gym.Env, sharing: Mapping[str, str] | None = None) -> None:
        self.env, self.twin, self.sharing = env, twin, sharing or {}
        self.cls = type(env)
        self.kinds: dict[str, Kind] = {}
        self.assigned: set[str] = set()
        self.read: set[str] = set()
        self.changed_in_place: set[str] = set()
        self.growing: set[str] = set()
        """The lists to which statements add, and that are always assigned as new lists."""
        self._not_lists: set[str] = set()
        self.shared: list[tuple[set[str], Callable[[], NotCompilable]]] = []
        """The attributes that share memory after an assignment, and the error if one of them is changed in place."""
        self._scan()

    def classes(self) -> Iterator[type]:
        """Yields the user's classes, from the most derived to the last."""
        return (one for one in self.cls.__mro__ if one.__module__.partition(".")[0] not in LIBRARY)

    def _scan(self) -> None:
        names = ["reset", "step", "action_masks", "action_mask"]
        for name in names:  # grows
            for cls in self.cls.__mro__[: self.cls.__mro__.index(gym.Env)]:
                member = vars(cls).get(name, MISSING)
                function = getattr(member, "fget", getattr(member, "__func__", member))
                if isinstance(function, FunctionType) and not hasattr(function, "__wrapped__"):
                    names += self._scan_function(source_of(function).node, set(names))
        self.read |= self.growing & self._not_lists
        self.growing -= self._not_lists

    def _scan_function(self, node: ast.FunctionDef, known: set[str]) -> list[str]:
        own = own_name(node) or ""
        more = set()
        grown = growing_lists(node, own)
        self.growing |= {one.attr for one in grown}
        lists = new_lists(node)
        for one in ast.walk(node):
            if isinstance(one, ast.Attribute) and isinstance(one.value, ast.Name):
                if one.value.id == own and one in grown:
                    pass
                elif one.value.id == own and isinstance(one.ctx, ast.Load):
                    self.read.add(one.attr)
                elif one.value.id == own:
                    self.assigned.add(one.attr)
                    if one not in lists:
                        self._not_lists.add(one.attr)
                more.add(one.attr)
            elif isinstance(one, ast.Attribute):
                more.add(one.attr)
            for target in _changed_parts(one):
                if isinstance(target.value, ast.Name) and target.value.id == own:
                    self.assigned.add(target.attr)
        return sorted(more - known - set(NOT_STEPPING))

    def find(self, name: str, after: type | None = None) -> tuple[Any, type | None]:
        """Returns a member of the class, and the class that defines it; after one class in the order if given."""
        order = self.cls.__mro__
        for cls in order[0 if after is None else order.index(after) + 1 :]:
            if name in vars(cls):
                return vars(cls)[name], cls
        return MISSING, None

    def kind(self, name: str, refuse: Refuse) -> Kind:
        """Returns the kind of an attribute that steps or resets change."""
        if name not in self.kinds:
            value = getattr(self.twin, name, MISSING)
            kind = kind_of(value)
            if value is MISSING:
                raise refuse(
                    f"self.{name} does not exist after reset", f"set self.{name} to a number or an array in __init__"
                )
            if kind is None or not _storable(kind):
                raise refuse(*_not_stored(name, value))
            self.kinds[name] = kind
        return self.kinds[name]

    def widen(self, name: str, kind: Kind, refuse: Refuse) -> None:
        """Notes the kind of a value that is assigned to an attribute."""
        before = self.kind(name, refuse)
        joined = join(before, kind)
        if isinstance(before, Array) and isinstance(kind, Array) and joined is not None:
            if kind.shape is not None and kind.shape != before.shape:
                advice = "keep the shape of the array"
                raise refuse(f"self.{name} changes its shape from {before.shape} to {kind.shape}", advice)
            return
        if joined is None:
            raise refuse(
                f"self.{name} is {in_words(before)} after reset, and {in_words(kind)} here",
                f"assign {in_words(before)} everywhere, converted explicitly",
            )
        if joined != before:
            self.kinds[name] = joined
            raise Restart

    def note_assigned(self, name: str) -> None:
        """Notes that an attribute is assigned."""
        if name not in self.assigned:
            self.assigned.add(name)
            raise Restart

    def note_read(self, name: str) -> None:
        """Notes that an assigned attribute is read, so that it cannot be left out."""
        if name not in self.read:
            self.read.add(name)
            raise Restart

    def check_sharing(self) -> None:
        """Refuses arrays that are changed in place while another name may refer to them."""
        for names, error in self.shared:
            if names & self.changed_in_place:
                raise error()
        for name in sorted(self.changed_in_place):
            if name in self.sharing:
                reason = f"self.{name} is changed in place, and shares memory with {self.sharing[name]}"
                raise NotCompilable(reason, advice=f"copy it where it is assigned, as in self.{name} = array.copy()")
            for other in self._same_memory(name):
                advice = f"copy it where it is assigned: self.{name} = self.{other}.copy()"
                raise NotCompilable(
                    f"self.{name} is changed in place, and shares memory with self.{other}", advice=advice
                )

    def _same_memory(self, name: str) -> Iterator[str]:
        """Yields the other attributes that share memory with one, before or after the reset of the copy."""
        for env in (self.env, self.twin):
            value = getattr(env, name, None)
            for other, one in getattr(env, "__dict__", {}).items():
                both = isinstance(one, np.ndarray) and isinstance(value, np.ndarray)
                same = np.shares_memory(one, value) if both else one is value and isinstance(value, list)
                if other != name and same:
                    yield other

    def record(self) -> tuple[np.dtype[Any], NDArray[Any]]:
        """Returns the type of the record, and the record before the first reset."""
        fields: list[Any] = []
        values: dict[str, Any] = {}
        for name, kind in sorted(self.kinds.items()):
            before, after = getattr(self.env, name, None), getattr(self.twin, name)
            usable = kind_of(before) is not None and join(kind_of(before), kind) is not None  # type: ignore[arg-type]
            if isinstance(kind, Array):
                usable = usable and np.shape(before) == kind.shape  # type: ignore[arg-type]
            for field, dtype, shape, value in _fields(name, kind, before if usable else after):
                fields.append((field, dtype, shape))
                values[field] = value
        dtype = np.dtype(fields or [("unused", np.uint8)], align=True)
        initial = np.zeros(1, dtype)
        for field, value in values.items():
            initial[field] = value
        return dtype, initial


def _changed_parts(node: ast.AST) -> Iterator[ast.Attribute]:
    """Yields the attributes whose elements a statement assigns."""
    targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AugAssign) else []
    for target in targets:
        for one in ast.walk(target):
            if isinstance(one, ast.Subscript) and isinstance(one.ctx, ast.Store):
                base: ast.expr = one
                while isinstance(base, ast.Subscript):
                    base = base.value
                if isinstance(base, ast.Attribute):
                    yield base
    called = node.func if isinstance(node, ast.Call) else None
    if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Attribute) and called.attr in CHANGING:
        yield called.value


def _storable(kind: Kind) -> bool:
    if isinstance(kind, TupleKind):
        return len(kind.items) <= 64 and all(
            isinstance(one, Scalar | TupleKind) and _storable(one) for one in kind.items
        )
    return isinstance(kind, Scalar | Array)


def _not_stored(name: str, value: Any) -> tuple[str, str]:
    """Returns why an attribute cannot be in the record, and what to use instead."""
    kind = type(value).__name__
    if value is None:
        return (
            f"self.{name} is None after reset, and changes later",
            "use a number for 'none yet', such as -1 or math.nan",
        )
    if isinstance(value, str):
        return f"self.{name} is a string that changes", "number the choices: use an integer"
    if isinstance(value, list | tuple):
        advice = "use a NumPy array of fixed size, with the number of its elements in use as an integer"
        return f"self.{name} is a {kind} that changes", advice
    if isinstance(value, dict | set):
        return (
            f"self.{name} is a {kind} that changes",
            "use a NumPy array indexed by integers, or one attribute for each key",
        )
    if isinstance(value, np.random.Generator | np.random.RandomState):
        return f"self.{name} is a second random generator", "draw from self.np_random"
    if isinstance(value, enum.Enum):
        return (
            f"self.{name} is a member of {kind} that changes",
            f"keep its number, as in self.{name} = {kind}.{value.name}.value",
        )
    return f"self.{name} is an object of type {kind} that changes", "keep its numbers as attributes of the environment"


def _fields(name: str, kind: Kind, value: Any) -> Iterator[tuple[str, Any, tuple[int, ...], Any]]:
    if isinstance(kind, TupleKind):
        for i, (item, part) in enumerate(zip(kind.items, value, strict=True)):
            yield from _fields(f"{name}.{i}", item, part)
    elif isinstance(kind, Array):
        dtype = np.uint8 if kind.dtype == "bool" else np.dtype(kind.dtype)
        yield name, dtype, kind.shape or (), value
    elif isinstance(kind, Scalar):
        dtypes = {"bool": np.bool_, "int": np.int64, "float": np.float64, "mixed": np.float64}
        yield name, dtypes.get(kind.name, kind.name), (), value


def own_attribute(obj: Any, name: str) -> Any:
    """Returns a plain attribute of an object, without running code; ``MISSING`` for properties and unknown names."""
    try:
        found = inspect.getattr_static(obj, name)
    except AttributeError:
        return MISSING
    plain = not hasattr(type(found), "__get__") or isinstance(found, FunctionType) or inspect.ismemberdescriptor(found)
    return getattr(obj, name) if plain else MISSING

"""Abstract values: what is known about an expression before it is run."""

import enum
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from qtab.compilation.twins.own_code import OPERATORS


@dataclass(frozen=True)
class Scalar:
    """A number. ``int`` and ``float`` have 64 bits, whether Python's or NumPy's."""

    name: str
    """``bool``, ``int``, ``float``, ``mixed`` (an integer or a float), or the name of another NumPy dtype."""


@dataclass(frozen=True)
class Array:
    """A NumPy array."""

    dtype: str
    ndim: int
    shape: tuple[int, ...] | None = None
    """None if it is not known before the program runs."""


@dataclass(frozen=True)
class TupleKind:
    """A tuple, or a list that is never changed."""

    items: "tuple[Kind, ...]"


@dataclass(frozen=True)
class DictKind:
    """A dict with constant keys; in compiled code a tuple of its values."""

    keys: tuple[Any, ...]
    items: "tuple[Kind, ...]"


@dataclass(frozen=True)
class InfoKind:
    """An info dict, which compiled code leaves out."""


Kind: TypeAlias = Scalar | Array | TupleKind | DictKind | InfoKind

BOOL, INT, FLOAT, MIXED, INFO = Scalar("bool"), Scalar("int"), Scalar("float"), Scalar("mixed"), InfoKind()
WIDE = (BOOL, INT, FLOAT, MIXED)
"""The scalars that compute the same in Python, NumPy and compiled code."""
REAL = (INT, FLOAT, MIXED)

LIBRARIES = ("builtins", "enum", "numpy")
"""The modules of the numbers and enums whose operators are known."""
DYNAMIC: Any = type("Dynamic", (), {"__repr__": lambda _: "<known at run time>"})()
"""``Value.fixed`` of a value that is not a constant."""


@dataclass(frozen=True, eq=False)
class Value:
    """What is known about an expression.

    A constant has ``fixed``, and neither kind nor code until it is lifted into the compiled program.
    """

    kind: Any = None
    code: str = ""
    fixed: Any = DYNAMIC
    parts: "tuple[Value, ...] | None" = None
    """The elements of a tuple that is written out in the code."""
    fresh: bool = False
    """Whether an array was made by this expression, so that no other name refers to its memory."""
    frozen: bool = False
    """Whether it is an array that nothing changes, a constant."""
    action: bool = False
    """Whether it is the action that ``step`` was given."""
    views: frozenset[str] = frozenset()
    """The attributes whose memory it shares in Python, such as that of ``self.board[0]``."""
    raw: str = ""
    """The code of the bytes of an array of booleans that is in the record."""

    @property
    def is_fixed(self) -> bool:
        """Whether the value is a constant."""
        return self.fixed is not DYNAMIC


def constant(value: Any) -> Value:
    """Returns a constant."""
    return Value(fixed=value)


def scalar_of(dtype: str) -> Scalar:
    """Returns the kind of an array's elements."""
    return {"bool": BOOL, "int64": INT, "float64": FLOAT}.get(dtype, Scalar(dtype))


def dtype_of(kind: Scalar) -> str:
    """Returns the dtype of an array of such numbers."""
    return {"bool": "bool", "int": "int64", "float": "float64", "mixed": "float64"}.get(kind.name, kind.name)


def numpy_type(dtype: str) -> str:
    """Returns the code of the NumPy type with the name of a dtype."""
    return "np.bool_" if dtype == "bool" else f"np.{dtype}"


def is_immutable(value: Any) -> bool:
    """Returns whether an augmented assignment to a value makes a new one, instead of changing it."""
    return type(value) in (bool, int, float, str, tuple, type(None)) or isinstance(value, np.generic)


def own_operator(value: Any) -> str | None:
    """Returns the name of an operator that a class derived from a number or an enum defines, such as ``__add__``.

    Also that of a number in a collection. None if there is none.
    """
    if isinstance(value, tuple | list | set | frozenset | dict):
        inner = [*value, *value.values()] if isinstance(value, dict) else value
        return next((name for name in map(own_operator, inner) if name is not None), None)
    if not isinstance(value, int | float | np.generic | enum.Enum):
        return None
    for cls in type(value).__mro__:
        if cls.__module__.partition(".")[0] in LIBRARIES:
            continue
        for name, member in vars(cls).items():
            if name in OPERATORS and not _is_inherited(type(value), name, member):
                return name
    return None


def _is_inherited(cls: type, name: str, member: Any) -> bool:
    """Returns whether a member is the library's, as enums repeat some methods in each class."""
    libraries = [one for one in cls.__mro__ if one.__module__.partition(".")[0] in LIBRARIES]
    if getattr(member, "__module__", None) == "enum":
        return True
    return any(vars(one).get(name) is member for one in libraries) or (
        issubclass(cls, enum.Enum) and any(member is getattr(one, name, None) for one in (int, float, object))
    )


def kind_of(value: Any) -> Kind | None:
    """Returns the kind of a Python value; None for what has none, such as a string or a number with own operators."""
    if own_operator(value) is not None:
        return None
    if isinstance(value, bool | np.bool_):
        return BOOL
    if isinstance(value, int):
        return INT if -(2**63) <= value < 2**63 else None
    if isinstance(value, float):
        return FLOAT
    if isinstance(value, np.generic):
        return scalar_of(value.dtype.name) if value.dtype.kind in "iuf" and value.dtype.itemsize <= 8 else None
    if isinstance(value, np.ndarray):
        simple = value.dtype.kind in "biuf" and value.dtype.itemsize <= 8 and value.dtype.isnative
        return Array(value.dtype.name, value.ndim, value.shape) if simple and value.ndim else None
    if type(value) in (tuple, list):
        kinds = [kind_of(part) for part in value]
        return None if any(kind is None for kind in kinds) else TupleKind(tuple(kinds))  # type: ignore[arg-type]
    return None


def join(one: Kind, other: Kind) -> Kind | None:
    """Returns the kind of a value that is of either kind; None if compiled code cannot hold both."""
    if one == other:
        return one
    if isinstance(one, Scalar) and isinstance(other, Scalar):
        return MIXED if {one, other} <= {INT, FLOAT, MIXED} else None
    if isinstance(one, Array) and isinstance(other, Array):
        same = (one.dtype, one.ndim) == (other.dtype, other.ndim)
        return Array(one.dtype, one.ndim) if same else None
    if isinstance(one, TupleKind) and isinstance(other, TupleKind) and len(one.items) == len(other.items):
        kinds = [join(*pair) for pair in zip(one.items, other.items, strict=True)]
        return None if any(kind is None for kind in kinds) else TupleKind(tuple(kinds))  # type: ignore[arg-type]
    if isinstance(one, DictKind) and isinstance(other, DictKind) and one.keys == other.keys:
        inner = join(TupleKind(one.items), TupleKind(other.items))
        return DictKind(one.keys, inner.items) if isinstance(inner, TupleKind) else None
    return None


def in_words(kind: Any) -> str:
    """Returns the name of a kind for a message."""
    match kind:
        case Scalar("bool"):
            return "a boolean"
        case Scalar("int"):
            return "an integer"
        case Scalar("float"):
            return "a float"
        case Scalar("mixed"):
            return "sometimes an integer and sometimes a float"
        case Scalar(name):
            return f"a NumPy {name}"
        case Array(dtype, ndim, shape):
            return f"an array of {dtype} {f'with shape {shape}' if shape is not None else f'with {ndim} dimensions'}"
        case TupleKind(items):
            return f"a tuple of {len(items)}"
        case DictKind():
            return "a dict"
        case InfoKind():
            return "an info dict"
    return "None" if kind is None else "an object"

"""Code of the user that runs where data is read, computed with or copied."""

import enum
import inspect
from collections.abc import Iterator
from dataclasses import is_dataclass
from types import FunctionType, ModuleType
from typing import Any

UNUSED = (
    *("__class__", "__delattr__", "__dir__", "__doc__", "__getnewargs__", "__getstate__", "__hash__", "__init__"),
    *("__init_subclass__", "__new__", "__reduce__", "__reduce_ex__", "__setattr__", "__sizeof__", "__subclasshook__"),
)
OPERATORS = frozenset(
    name
    for name in (*dir(int), *dir(float), "__getattr__", "__len__", "__iter__", "__getitem__", "__contains__")
    if name.startswith("__") and name not in UNUSED
)
"""The methods that Python calls for operators, conversions and built-in functions."""
RUN = (OPERATORS - {"__repr__", "__str__", "__format__"}) | {
    *("__copy__", "__deepcopy__", "__getstate__", "__new__", "__reduce__", "__reduce_ex__", "__setstate__"),
}
"""The methods that run where data is read, compared, computed with or copied."""
GENERATORS = ("collections", "dataclasses", "typing")
COLLECTIONS: tuple[type, ...] = (tuple, list, set, frozenset, dict)


def has_own_code(cls: type) -> bool:
    """Returns whether a named tuple or a dataclass has its own code for attributes, elements, operators or copies."""
    members = [one for base in cls.__mro__ if base not in (tuple, object) for one in vars(base).items()]
    functions = [(name, getattr(member, "__func__", member)) for name, member in members]
    return any(
        name in RUN and isinstance(function, FunctionType) and not _is_generated(function)
        for name, function in functions
    )


def _is_generated(function: FunctionType) -> bool:
    """Returns whether a method was written by ``dataclasses`` or ``namedtuple``."""
    code = function.__code__
    return code.co_filename.startswith("<string>") or function.__globals__.get("__name__") in GENERATORS


def own_methods(value: Any) -> Iterator[tuple[str, FunctionType]]:
    """Yields the methods that Python calls to compute with a number, an enum or data, or to show it, with their names.

    Only those that the user has written; also those of the elements of a collection.
    """
    if type(value) in COLLECTIONS:
        items: Any = [*value, *value.values()] if isinstance(value, dict) else value
        for one in items:
            yield from own_methods(one)
    elif isinstance(value, int | float | tuple | enum.Enum) or is_dataclass(value):
        cls: Any = type(value)
        for base in cls.__mro__:
            for name, member in vars(base).items():
                is_own = isinstance(member, FunctionType) and member.__module__ != "enum" and not _is_generated(member)
                if name in OPERATORS and is_own:
                    yield name, member


def is_computed(member: Any) -> bool:
    """Returns whether a member of a class is a descriptor other than a method or a field, such as a property."""
    is_field = type(member).__name__ in ("member_descriptor", "getset_descriptor")
    known: Any = FunctionType | staticmethod | classmethod | type
    return hasattr(type(member), "__get__") and not isinstance(member, known) and not is_field


def runs_code(value: Any, name: str) -> bool:
    """Returns whether reading an attribute of a constant calls code of the user, such as that of a property."""
    if isinstance(inspect.getattr_static(type(value), "__getattribute__"), FunctionType):
        return True
    owner = value.__name__ if isinstance(value, ModuleType) else getattr(value, "__module__", type(value).__module__)
    if str(owner).partition(".")[0] in ("builtins", "numpy", "gymnasium"):
        return False
    if isinstance(value, ModuleType):
        return name not in vars(value) and "__getattr__" in vars(value)
    if isinstance(value, enum.EnumMeta) and name in value.__members__:
        return False
    try:
        found = inspect.getattr_static(value, name)
    except AttributeError:
        return hasattr(type(value), "__getattr__")
    if isinstance(value, type) and any(name in vars(cls) for cls in value.__mro__):
        known: Any = FunctionType | staticmethod | classmethod | property | type
    elif getattr(getattr(found, "fget", None), "__module__", None) == "enum":  # its name and value
        return False
    else:
        known = FunctionType | staticmethod | classmethod | type
    is_field = type(found).__name__ in ("member_descriptor", "_tuplegetter", "getset_descriptor")
    is_builtin = type(found).__module__ == "builtins" and not isinstance(found, property)
    return hasattr(type(found), "__get__") and not (isinstance(found, known) or is_field or is_builtin)

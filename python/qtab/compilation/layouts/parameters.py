"""``self`` in compiled code: the attributes that the functions read, as memory, and their methods."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab.compilation.layouts.value_layout import Layout, Tuple, encode, layout_of

CONSTANTS = (str, type(None))
"""The types of attributes that are compiled into the code."""


@dataclass(frozen=True)
class Parameters:
    """The attributes of an environment that its functions read."""

    values: dict[str, Any]
    """The numbers, tuples and arrays, by their names."""
    constants: dict[str, Any] = field(default_factory=dict)
    """The texts, and attributes that are None: a change of them needs a new compilation."""
    refused: dict[str, str] = field(default_factory=dict)
    """Attributes that cannot be compiled, with the reason."""

    @classmethod
    def of(cls, env: Any, names: set[str]) -> "Parameters":
        """Returns the attributes of an environment that have these names and are not methods."""
        values, constants, refused = {}, {}, {}
        for name in sorted(names):
            if isinstance(getattr(type(env), name, None), property):
                refused[name] = f"self.{name} is a property, which would be read once only: write a method"
                continue
            try:
                value = getattr(env, name)
            except Exception:  # noqa: S112 - a property that needs a state, for one: its use is refused
                continue
            if isinstance(value, CONSTANTS):
                constants[name] = value
                continue
            try:
                layout_of(value)
            except TypeError as error:
                refused[name] = f"self.{name} contains a value of type {error}"
            except OverflowError as error:
                refused[name] = f"self.{name} cannot be stored: {error}"
            else:
                values[name] = value
        return cls(values, constants, refused)

    @property
    def layout(self) -> Tuple:
        """The layout of the values in memory, in the order of their names."""
        layouts: list[Layout] = [layout_of(value) for value in self.values.values()]
        return Tuple(tuple(layouts))

    def memory(self) -> NDArray[np.uint8]:
        """Returns the values as bytes."""
        return encode(self.layout, tuple(self.values.values()))

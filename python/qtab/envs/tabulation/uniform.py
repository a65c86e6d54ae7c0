"""A uniform random number of which only comparisons are known."""

from fractions import Fraction
from functools import lru_cache
from typing import Any, NoReturn

import numpy as np

from qtab.envs.tabulation.branches import Branches


class Uniform:
    """A uniform random number in [low, high) that the environment only compares with other numbers.

    Each comparison has two outcomes, whose probabilities follow from the interval in which the number lies after the
    comparisons before. The number is taken as real: NumPy's ``random()`` is a multiple of 2**-53, so that the
    probability of a comparison may differ by 2**-53.

    Args:
        branches: The draws of the function.
        call: The call that drew the number, such as ``"rng.random()"``.
        low: The lower end.
        high: The upper end.
    """

    __array_ufunc__ = None  # NumPy's numbers and arrays leave comparisons to this class
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, branches: Branches, call: str, low: float = 0.0, high: float = 1.0) -> None:
        self._branches, self._call = branches, call
        self._low, self._high = low, high

    def __repr__(self) -> str:
        return self._call

    def __lt__(self, other: Any) -> Any:
        return self._below(other)

    def __le__(self, other: Any) -> Any:
        return self._below(other)

    def __gt__(self, other: Any) -> Any:
        below = self._below(other)
        return ~below if isinstance(below, np.ndarray) else not below

    __ge__ = __gt__

    def __copy__(self) -> "Uniform":
        return self

    def __deepcopy__(self, memo: Any) -> "Uniform":
        return self

    def __eq__(self, other: object) -> bool:
        return self is other or self.refuse("compared by ==")

    def __ne__(self, other: object) -> bool:
        return self is not other and self.refuse("compared by !=")

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):  # NumPy and copy look for optional methods
            raise AttributeError(name)
        return self.refuse(f"asked for its {name}")

    def _below(self, other: Any) -> Any:
        if isinstance(other, np.ndarray | np.floating) and other.dtype.kind == "f" and other.dtype.itemsize < 8:
            # NumPy rounds the random number to this type first.
            return self.refuse(f"compared with a {other.dtype.name}, which rounds it (convert the number with float())")
        if isinstance(other, np.ndarray):
            return np.array([self._below(item) for item in other.ravel().tolist()], np.bool_).reshape(other.shape)
        if isinstance(other, Uniform) or not isinstance(other, int | float | np.number | np.bool_):
            return self.refuse(f"compared with {other!r:.50}")
        number = float(other)
        if not self._low < number < self._high:  # NaN is neither above nor below
            return number >= self._high
        sides = _sides(self._low, number, self._high)
        if self._branches.draw(f"{self._call} < {number!r}", sides) == 0:
            self._high = number
            return True
        self._low = number
        return False

    def refuse(self, use: str) -> NoReturn:
        """Raises the error for a use other than a comparison.

        Raises:
            CannotListError: always.
        """
        raise self._branches.refused(
            f"{self._call}, a continuous number that is {use}; only comparisons with < and > can be listed"
        )


@lru_cache(maxsize=4096)
def _sides(low: float, number: float, high: float) -> tuple[Fraction, Fraction]:
    """Returns the probabilities that a uniform number in [low, high) is below another one, and that it is not."""
    below = (Fraction(number) - Fraction(low)) / (Fraction(high) - Fraction(low))
    return below, 1 - below


def _refusing(use: str) -> Any:
    def method(self: Uniform, *_: Any, **__: Any) -> Any:
        self.refuse(use)

    return method


for _name in ("add", "radd", "sub", "rsub", "mul", "rmul", "truediv", "rtruediv", "floordiv", "mod", "pow", "rpow"):
    setattr(Uniform, f"__{_name}__", _refusing("computed with"))
for _name in ("neg", "abs", "round", "floor", "ceil", "trunc", "divmod", "rfloordiv", "rmod"):
    setattr(Uniform, f"__{_name}__", _refusing("computed with"))
for _name in ("bool", "int", "float", "index", "complex"):
    setattr(Uniform, f"__{_name}__", _refusing("used as a number"))
setattr(Uniform, "__array__", _refusing("put into an array"))  # noqa: B010 - as those above

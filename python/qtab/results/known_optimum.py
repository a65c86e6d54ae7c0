"""The attributes that results read from the optimum of their environment."""

from typing import Any, Protocol


class KnownOptimum(Protocol):
    """A result of :func:`qtab.optimum`, whose class is in a package that imports this one."""

    @property
    def expected_return(self) -> float:
        """The expected return of the best policy."""

    @property
    def label(self) -> str:
        """``"optimum"``, or ``"best known"`` if the result is not exact."""

    @property
    def exact(self) -> bool:
        """True if it is proven that no policy has a higher expected return."""

    @property
    def stationary(self) -> Any:
        """The best policy that ignores the number of steps taken; None if unknown."""

    @property
    def solver(self) -> Any:
        """The solver, which computes the expected return of other policies."""

"""What results need to know of the optimum of their environment."""

from typing import Any, Protocol


class KnownOptimum(Protocol):
    """A result of :func:`qtab.optimum`, which is made in a package above this one."""

    @property
    def expected_return(self) -> float:
        """The expected return of the best policy."""

    @property
    def label(self) -> str:
        """What it is: the optimum, or the best known return."""

    @property
    def exact(self) -> bool:
        """Whether no policy returns more."""

    @property
    def stationary(self) -> Any:
        """The best policy that does not count the steps; None where it is not known."""

    @property
    def solver(self) -> Any:
        """Computes the return of other policies."""

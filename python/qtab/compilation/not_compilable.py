"""The errors for an environment that cannot be compiled, with the place and the advice."""

from collections.abc import Iterable, Sequence

MOST_PROBLEMS = 10
"""The most problems that a message lists."""


class NotCompilable(Exception):  # noqa: N818 - it is no fault of the environment, which Python can step
    """An environment cannot be compiled, or its compiled code would not give the same numbers.

    Args:
        reason: The reason.
        file: The user's file; None if it is not known.
        line: The line in it; None if it is not known.
        advice: What to write instead; an empty text if there is no advice.
        others: The other problems that were found.
    """

    def __init__(
        self,
        reason: str,
        file: str | None = None,
        line: int | None = None,
        advice: str = "",
        others: "Iterable[NotCompilable]" = (),
    ) -> None:
        place = "" if file is None else f"{file}:{line}: " if line is not None else f"{file}: "
        self.place_and_reason = place + reason
        super().__init__(self.place_and_reason + (f"; {advice}" if advice else ""))
        self.reason, self.file, self.line, self.advice = reason, file, line, advice
        self.others: tuple[NotCompilable, ...] = tuple(others)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.reason, self.file, self.line, self.advice, self.others)

    @property
    def problems(self) -> list[str]:
        """All problems that were found, each with its place and the advice."""
        shown = [str(one) for one in (self, *self.others)]
        left = len(shown) - MOST_PROBLEMS
        return shown if left <= 0 else [*shown[:MOST_PROBLEMS], f"and {left} more"]


def combined(problems: Sequence[NotCompilable]) -> NotCompilable:
    """Returns one error for several, the first of them with the others; each is listed once."""
    once: dict[object, NotCompilable] = {}
    for one in problems:
        once.setdefault((one.file, one.line, one.reason), one)
    first, *others = once.values()
    return type(first)(first.reason, first.file, first.line, first.advice, others)


class Follows(NotCompilable):
    """Code cannot be compiled because other code cannot, which was noted already."""


class NotNow(NotCompilable):
    """An environment was not compiled for a reason that may not hold for other attributes, or another time."""

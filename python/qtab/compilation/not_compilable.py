"""The errors for an environment that cannot be compiled, with the place and the advice."""


class NotCompilable(Exception):  # noqa: N818 - it is no fault of the environment, which Python can step
    """An environment cannot be compiled, or its compiled code would not give the same numbers.

    Args:
        reason: The reason.
        file: The user's file; None if it is not known.
        line: The line in it; None if it is not known.
        advice: What to write instead; an empty text if there is no advice.
    """

    def __init__(self, reason: str, file: str | None = None, line: int | None = None, advice: str = "") -> None:
        place = "" if file is None else f"{file}:{line}: " if line is not None else f"{file}: "
        self.place_and_reason = place + reason
        super().__init__(self.place_and_reason + (f"; {advice}" if advice else ""))
        self.reason, self.file, self.line, self.advice = reason, file, line, advice

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.reason, self.file, self.line, self.advice)


class NotNow(NotCompilable):
    """An environment was not compiled for a reason that may not hold for other attributes, or another time."""

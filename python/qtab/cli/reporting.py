"""The output of a command: text for people, one JSON object for programs, or nothing."""

import dataclasses
import json
import logging
import math
import sys
import warnings
from argparse import Namespace
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from qtab._utils.progress import print_above
from qtab.cli.errors import UsageError, one_line
from qtab.cli.interruption import discard_output


class Report:
    """The output of a command. A context manager that prints the JSON object at its end, if that was asked for.

    After an exception it is printed as well, with the keys that were added before.

    Args:
        options: The arguments of the command, with those of :meth:`~qtab.cli.parser.Parser.output_flags`.

    Raises:
        UsageError: if both flags are given.
    """

    def __init__(self, options: Namespace) -> None:
        if options.json and options.quiet:
            raise UsageError("--json must be given without --quiet, which prints nothing")
        self._options = options
        self._facts: dict[str, Any] = {}
        self._on_exit = ExitStack()
        self.progress: bool | None = False if options.quiet else None
        """Whether to show progress bars, as the argument ``progress`` of the API."""
        self.writes_files = False
        """Whether the command writes files: it then finishes even if its output is closed, as ``| head`` does."""

    def __enter__(self) -> "Report":
        if self._options.quiet:
            self._on_exit.enter_context(_without_messages())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._on_exit.close()
        if self._options.json and self._facts:
            self._print(json_text({"command": self._options.command, **self._facts}))

    def text(self, lines: str) -> None:
        """Prints text for people."""
        if not (self._options.quiet or self._options.json):
            self._print(lines)

    def _print(self, lines: str) -> None:
        try:
            print_above(lines)
        except BrokenPipeError:
            discard_output()
            if not self.writes_files:
                raise

    def problem(self, error: Exception) -> None:
        """Reports an error after which the command continues: as text, or on standard error."""
        if self._options.quiet or self._options.json:
            sys.stderr.write(f"{self._options.command}: error: {one_line(error)}\n")
        else:
            self._print(str(error))

    def add(self, **facts: Any) -> None:
        """Adds keys to the JSON object."""
        self._facts |= facts


@contextmanager
def _without_messages() -> Iterator[None]:
    """Keeps warnings and the messages of the logger ``qtab`` away from standard error."""
    logger = logging.getLogger("qtab")
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.setLevel(level)


def json_text(value: Any) -> str:
    """Returns a value as JSON in one line; NaN and infinities, which JSON lacks, become null."""
    return json.dumps(_to_json(value), allow_nan=False)


def _to_json(value: Any) -> Any:
    if dataclasses.is_dataclass(value):
        value = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(name): _to_json(item) for name, item in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_to_json(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, bool | int | str):
        return value
    return str(value) if isinstance(value, Path) else repr(value)

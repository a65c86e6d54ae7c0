"""Reading a TOML file that is named on the command line."""

import sys
from pathlib import Path
from typing import Any

from qtab._utils.extras import missing
from qtab._utils.shown import shown
from qtab.cli.errors import reading


def read_toml(argument: str, path: Path) -> dict[str, Any]:
    """Returns the content of a TOML file.

    Args:
        argument: The argument that names the file, for messages.
        path: The file.

    Raises:
        UsageError: if the file cannot be read.
        ValueError: if it is not TOML.
        ModuleNotFoundError: on Python 3.10 without tomli; it names the ``pip install``.
    """
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        try:
            import tomli as tomllib
        except ModuleNotFoundError as error:
            raise missing(error, "cli") from error
    with reading(argument, path), path.open("rb") as file:
        try:
            return tomllib.load(file)
        except (ValueError, RecursionError) as error:
            reason = "it is nested too deeply" if isinstance(error, RecursionError) else error
            raise ValueError(f"{argument} must be a TOML file, got {shown(str(path))}: {reason}") from None

"""The ``qtab`` command."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns its exit code.

    It is 0 (success), 1 (failure), 2 (bad usage), 130 (Ctrl-C) or 143 (SIGTERM).

    Args:
        arguments: The arguments after the command's name; None means those of the process.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by the shell (>&-), or a program without a console on Windows
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115 - until the process ends
    from qtab.cli.encoding import write_names_of_letters
    from qtab.cli.interruption import exit_code, sigterm_as_ctrl_c

    write_names_of_letters()
    with sigterm_as_ctrl_c():
        try:
            from qtab.cli.command import run
        except KeyboardInterrupt as error:
            return exit_code(error)
        return run(list(sys.argv[1:] if arguments is None else arguments))

"""The ``qtab`` command."""

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns its exit code.

    It is 0 (success), 1 (failure), 2 (bad usage), 130 (Ctrl-C) or 143 (SIGTERM). The command of the process finds
    modules of the current folder, such as ``parts`` for the environment ``parts:Id-v0``.

    Args:
        arguments: The arguments after the command's name; None means those of the process.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by the shell (>&-), or a program without a console on Windows
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115 - until the process ends
    if arguments is None:
        _search_current_folder()
    from qtab.cli.encoding import write_names_of_letters
    from qtab.cli.interruption import exit_code, sigterm_as_ctrl_c

    write_names_of_letters()
    with sigterm_as_ctrl_c():
        try:
            from qtab.cli.command import run
        except KeyboardInterrupt as error:
            return exit_code(error)
        return run(list(sys.argv[1:] if arguments is None else arguments))


def _search_current_folder() -> None:
    """Puts the current folder at the end of the search path of modules, unless Python was told not to.

    At its start, a file such as ``random.py`` would be imported instead of Python's module.
    """
    if getattr(sys.flags, "safe_path", False):  # PYTHONSAFEPATH, from Python 3.11 on
        return
    with suppress(OSError):  # the folder was deleted
        folder = str(Path.cwd())
        if folder not in sys.path and "" not in sys.path:
            sys.path.append(folder)

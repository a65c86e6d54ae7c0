"""The ``qtab`` command."""

import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns its exit code: 0, 1 (it went wrong), 2 (bad usage) or 130 (Ctrl-C).

    Args:
        arguments: What follows the command's name; None takes the process's own.
    """
    try:
        import tyro  # noqa: F401 - every subcommand needs it

        from qtab.cli.command import run
    except ModuleNotFoundError as error:
        if error.name != "tyro":
            raise
        from qtab._utils.extras import missing

        sys.stderr.write(f"qtab: error: {missing(error, 'cli')}\n")
        return 1
    except KeyboardInterrupt:
        return 130
    return run(list(sys.argv[1:] if arguments is None else arguments))

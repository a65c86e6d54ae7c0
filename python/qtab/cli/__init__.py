"""The ``qtab`` command."""

import sys
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns its exit code: 0 (success), 1 (failure), 2 (bad usage) or 130 (Ctrl-C).

    Args:
        arguments: The arguments after the command's name; None means those of the process.
    """
    try:
        import tyro  # noqa: F401 - all subcommands need it

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

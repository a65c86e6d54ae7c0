"""From the first word to its subcommand, and from errors to exit codes."""

import os
import sys
from importlib import import_module

import gymnasium as gym

from qtab.cli.usage import UsageError, one_line

SUBCOMMANDS = {
    "train": "train a tabular agent, plot and save what it learned, show its last episodes",
    "verify": "replay a saved run through Gymnasium and NumPy, and compare byte for byte",
    "optimum": "compute the best that can be returned: exactly from a table, or the best that is known",
    "sweep": "train many settings over many seeds, as a file says; called again, it goes on",
    "report": "turn a sweep's store into tables, pictures and one HTML page",
    "book": "run an experiment of Sutton & Barto's book: its settings, a table, a figure",
    "bench": "time this package against Gymnasium and the article's loop",
}
"""Each is a module of this package with ``run(arguments) -> exit code``."""

EXIT_ERROR, EXIT_USAGE, EXIT_INTERRUPTED = 1, 2, 130


def run(arguments: list[str]) -> int:
    """Runs the command line and returns its exit code; what goes wrong is told in one line."""
    name = "qtab"
    try:
        if not arguments or arguments[0] in ("-h", "--help"):
            print(_help())  # noqa: T201
            return 0 if arguments else EXIT_USAGE
        if arguments[0] == "--version":
            import qtab

            print(f"qtab {qtab.__version__}")  # noqa: T201
            return 0
        if arguments[0] not in SUBCOMMANDS:
            raise UsageError(f"there is no {arguments[0]!r}; there are {', '.join(SUBCOMMANDS)}, --help and --version")
        name = f"qtab {arguments[0]}"
        code = import_module(f"qtab.cli.{arguments[0]}").run(arguments[1:])
        sys.stdout.flush()
        return int(code)
    except UsageError as error:
        return _fail(name, error, EXIT_USAGE)
    except BrokenPipeError:
        # Whoever read the output has gone; Python's own flush at exit must not complain about it.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_ERROR
    except (ValueError, TypeError, OverflowError, OSError, ModuleNotFoundError, gym.error.Error) as error:
        return _fail(name, error, EXIT_ERROR)
    except KeyboardInterrupt:
        return EXIT_INTERRUPTED


def _fail(name: str, error: Exception, code: int) -> int:
    sys.stdout.flush()
    sys.stderr.write(f"{name}: error: {one_line(error)}\n")
    return code


def _help() -> str:
    listed = "\n".join(f"  {name:8}{summary}" for name, summary in SUBCOMMANDS.items())
    return (
        "usage: qtab COMMAND [OPTIONS]\n\n"
        "Tabular reinforcement learning on Gymnasium environments, from Rust.\n\n"
        f"commands:\n{listed}\n\n"
        "options:\n  --help    show this, or with a command before it, the command's options\n"
        "  --version show the version"
    )

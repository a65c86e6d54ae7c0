"""The choice of the subcommand, and the exit codes of errors."""

import sys
from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING

from qtab._utils.shown import did_you_mean, shown
from qtab.cli.errors import USER_ERRORS, UsageError, one_line, with_origin
from qtab.cli.interruption import discard_output, exit_code

if TYPE_CHECKING:
    from qtab.cli.parser import Parser

SUBCOMMANDS = {
    "train": "train a tabular agent, save and plot the run, replay its last episodes",
    "resume": "continue a saved run exactly where it stopped, or for more episodes",
    "verify": "repeat a saved run with Gymnasium and NumPy, and compare the results byte for byte",
    "explain": "show steps of an episode of a saved run: each choice, and each update with its numbers",
    "diagnose": "report why a saved run did not solve its environment, and what to change",
    "watch": "show the greedy policy of a saved run in a window",
    "record": "write a video of the greedy policy of a saved run: MP4, GIF or HTML",
    "optimum": "compute the best policy of an environment: exact from a table, or the best known",
    "sweep": "train many settings with many seeds, as a study file describes; resumes if called again",
    "report": "turn the store of a sweep into tables, plots and one HTML page",
    "book": "run an experiment of Sutton & Barto's book: its settings, a table, a figure",
    "exercises": "list the exercises, hand them out to a class, grade a folder of submissions",
    "playground": "open a page that trains agents in the browser",
    "bench": "compare the speed of training with the article's plain loop",
    "completion": "print the script that completes commands, flags and choices in bash or zsh",
}
"""The subcommands with their help. Each is a module of ``commands``."""

EXIT_ERROR, EXIT_USAGE = 1, 2


def run(arguments: list[str]) -> int:
    """Runs the command line and returns its exit code. An error is reported in one line."""
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
            suggestion = did_you_mean(arguments[0], [*SUBCOMMANDS, "--help", "--version"])
            raise UsageError(f"unknown command {shown(arguments[0])}{suggestion}; use {', '.join(SUBCOMMANDS)}")
        name = f"qtab {arguments[0]}"
        options = parser_of(arguments[0], arguments[1:]).read()
        code = import_module(f"qtab.cli.commands.{arguments[0]}").run(options)
        sys.stdout.flush()
        return int(code)
    except UsageError as error:
        return _fail(name, one_line(error), EXIT_USAGE)
    except BrokenPipeError:
        discard_output()
        return EXIT_ERROR
    except USER_ERRORS as error:
        return _fail(name, one_line(error), EXIT_ERROR)
    except KeyboardInterrupt as error:
        return exit_code(error)
    except Exception as error:
        return _fail(name, with_origin(error), EXIT_ERROR)


def parser_of(name: str, words: Sequence[str] = ()) -> "Parser":
    """Returns the parser of a subcommand for the words that follow its name."""
    from qtab.cli.parser import Parser

    module = import_module(f"qtab.cli.commands.{name}")
    parser = Parser(f"qtab {name}", module.__doc__, words)
    module.add_arguments(parser)
    return parser


def _fail(name: str, message: str, code: int) -> int:
    sys.stdout.flush()
    sys.stderr.write(f"{name}: error: {message}\n")
    return code


def _help() -> str:
    commands = "\n".join(f"  {name:11}{summary}" for name, summary in SUBCOMMANDS.items())
    return (
        "usage: qtab COMMAND [OPTIONS]\n\n"
        "Tabular and linear reinforcement learning on Gymnasium environments, in Rust.\n\n"
        f"commands:\n{commands}\n\n"
        "options:\n  --help    show this help; after a command, show the options of the command\n"
        "  --version show the version"
    )

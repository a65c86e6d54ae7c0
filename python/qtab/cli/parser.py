"""The parser of a subcommand: argparse, whose errors are one line in the words of this command."""

import argparse
import re
import textwrap
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Any

from qtab._utils.shown import shown
from qtab.cli import values
from qtab.cli.errors import UsageError, flag
from qtab.config.unknown import meant

REQUIRED = object()
"""The default of an argument that must be given."""
ENV_OF_RUN = "The environment's id, for one that a package registers (package:Name-v0): a file imports nothing."
"""The help of ``--env`` beside the file of a run."""
_MESSAGES = {"expected one argument": "needs a value", "ignored explicit argument": "takes no value, got"}
_METAVARS = {values.integer: "INT", values.number: "FLOAT", Path: "FILE", str: "STR"}


class Parser(argparse.ArgumentParser):
    """Reads the arguments of a subcommand.

    Args:
        command: The command, such as ``qtab train``.
        description: What it does, for ``--help``.
        words: The words after the command.
    """

    def __init__(self, command: str, description: str | None, words: Sequence[str]) -> None:
        super().__init__(command, command, description, formatter_class=_Help, exit_on_error=False, allow_abbrev=False)
        self.help_wanted = "-h" in words or "--help" in words
        self.words = [word for word in words if word not in ("-h", "--help")]
        self.set_defaults(command=command, words=self.words)
        self._negative_number_matcher = re.compile(r"-(\d|\.\d|inf|nan)")  # argparse's own refuses -1e3 and -inf
        self._without_flag: list[str] = []
        self._missing: dict[str, str] = {}

    def positional(
        self,
        name: str,
        text: str,
        read: Callable[[str], Any] = Path,
        default: Any = REQUIRED,
        metavar: str | None = None,
    ) -> None:
        """Adds an argument without a flag. See :meth:`option`."""
        shown_name = metavar or name.upper()
        self.usage = f"{self.usage} {shown_name}" if default is REQUIRED else f"{self.usage} [{shown_name}]"
        self._without_flag.append(shown_name.lower())
        self.add_argument(name, nargs="?", type=read, default=default, metavar=shown_name, help=_help(text, default))
        if default is REQUIRED:
            self._missing[name] = f"{shown_name} must be given: {text[0].lower()}{text[1:].rstrip('.')}"

    def option(
        self,
        name: str,
        read: Callable[[str], Any],
        text: str,
        default: Any = None,
        metavar: str | None = None,
    ) -> None:
        """Adds an option with a value.

        Args:
            name: The name in Python. The flag has hyphens in place of underscores.
            read: Returns the value of the word. Its ArgumentTypeErrors say what the word must be.
            text: The help.
            default: The value without the option. If it is None, the word None is read as None, too.
            metavar: What ``--help`` shows for the value; None takes it from ``read``.
        """
        self.add_argument(
            flag(name),
            type=values.or_none(read) if default is None else read,
            default=default,
            metavar=metavar or _METAVARS[read],
            help=_help(text, default),
            dest=name,
        )

    def switch(self, name: str, text: str) -> None:
        """Adds an option without a value: True if it is given."""
        self.add_argument(flag(name), action="store_true", help=_help(text))

    def output_flags(self) -> None:
        """Adds the options of every command that reports something."""
        self.switch("quiet", "Print nothing but errors.")
        self.switch("json", "Print one JSON object instead of text; progress is shown on standard error only.")

    def read(self) -> argparse.Namespace:
        """Returns the arguments by their names; or prints the help and exits, if that is asked for.

        Beside them are ``command``, ``words``, and the names of the ``flags`` and of the ``positionals``.

        Raises:
            UsageError: for arguments that cannot be parsed.
        """
        if self.help_wanted:
            self.usage = f"{self.usage} [OPTIONS]"
            self.print_help()
            self.exit()
        try:
            found, rest = self.parse_known_intermixed_args([_with_hyphens(word) for word in self.words])
        except argparse.ArgumentError as error:
            reason = error.message
            for theirs, ours in _MESSAGES.items():
                reason = reason.replace(theirs, ours)
            raise UsageError(f"{error.argument_name} {reason}; see {self.prog} --help") from None
        reasons = [reason for name, reason in self._missing.items() if getattr(found, name) is REQUIRED]
        if rest or reasons:
            reason = self._unknown(rest) if rest else reasons[0]
            raise UsageError(f"{reason}; see {self.prog} --help")
        found.flags, found.positionals = self.flags(), self._without_flag
        return found

    def _unknown(self, words: Sequence[str]) -> str:
        """Returns the message for words that are no arguments, about the first flag among them, or the first word."""
        word = next((word for word in words if word.startswith("-")), None)
        if word is None:
            return f"unexpected argument {shown(words[0])}"
        word = word.partition("=")[0]
        name = word.lstrip("-").replace("-", "_")
        flags = self.flags()
        if name not in flags and any(name == action.dest for action in self._actions):
            return f"unknown option {shown(word)[1:-1]} ({name} is given without a flag)"
        found = meant(name, flags)
        return f"unknown option {shown(word)[1:-1]}" + (f" (did you mean {flag(found)}?)" if found else "")

    def flags(self) -> Collection[str]:
        """Returns the names of the options in Python."""
        return [
            text[2:].replace("-", "_") for action in self._actions for text in action.option_strings if text[:2] == "--"
        ]


class Together(argparse.Action):
    """Reads all words that follow a flag together, by its argument ``read``."""

    def __init__(self, *args: Any, read: Callable[[values.Words], Any], **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._read = read

    def __call__(self, _parser: Any, namespace: argparse.Namespace, words: Any, _flag: str | None = None) -> None:
        """Stores the value."""
        try:
            setattr(namespace, self.dest, self._read(words))
        except argparse.ArgumentTypeError as error:
            raise argparse.ArgumentError(self, str(error)) from None


class _Help(argparse.HelpFormatter):
    def _split_lines(self, text: str, width: int) -> list[str]:
        return textwrap.wrap(" ".join(text.split()), width, break_on_hyphens=False)


def _help(text: str, default: Any = None) -> str:
    """Returns a help text with its default, of which argparse must not format the percent signs."""
    if default is not None and default is not REQUIRED:
        text += f" (default: {default})"
    return text.replace("%", "%%")


def _with_hyphens(word: str) -> str:
    """Returns a flag with hyphens instead of underscores."""
    name, equals, value = word.partition("=")
    return f"{name.replace('_', '-')}{equals}{value}" if word.startswith("--") else word

"""The parser of a subcommand: argparse, whose errors are one line in the words of this command."""

import argparse
import re
import textwrap
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, NoReturn

from qtab._utils.shown import shown
from qtab.cli import values
from qtab.cli.errors import UsageError, flag
from qtab.config.unknown import meant

REQUIRED = object()
"""The default of an argument that must be given."""
_MESSAGES = {"expected one argument": "needs a value", "ignored explicit argument": "takes no value, got"}
_METAVARS = {values.integer: "INT", values.number: "FLOAT", Path: "FILE", str: "STR"}


class Parser(argparse.ArgumentParser):
    """Reads the arguments of a subcommand.

    Args:
        command: The command, such as ``qtab train``.
        description: The description of the command, for ``--help``.
        words: The words after the command.
    """

    def __init__(self, command: str, description: str | None, words: Sequence[str]) -> None:
        super().__init__(command, command, description, formatter_class=_Help, exit_on_error=False, allow_abbrev=False)
        self.help_wanted = "-h" in words or "--help" in words
        self.words = [word for word in words if word not in ("-h", "--help")]
        self.set_defaults(command=command, words=self.words)
        # argparse's pattern does not match -1e3 and -inf
        self._negative_number_matcher = re.compile(r"-(\d|\.\d|inf|nan)", re.IGNORECASE)
        self._without_flag: list[tuple[argparse.Action, Callable[[str], Any]]] = []

    def positional(
        self,
        name: str,
        text: str,
        read: Callable[[str], Any] = Path,
        default: Any = REQUIRED,
        metavar: str | None = None,
    ) -> None:
        """Adds an argument without a flag. See :meth:`option`."""
        metavar = metavar or name.upper()
        self.usage = f"{self.usage} {metavar}" if default is REQUIRED else f"{self.usage} [{metavar}]"
        # It takes no words from argparse, which would read all arguments at the position of the first.
        taken = argparse.SUPPRESS
        action = self.add_argument(name, nargs=taken, default=default, metavar=metavar, help=_help(text, default))
        self._without_flag.append((action, read))

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
            read: Returns the value of the word. Its ArgumentTypeErrors name the accepted words.
            text: The help.
            default: The value without the option. If it is None, the word None is read as None, too.
            metavar: The name of the value in ``--help``; None takes it from ``read``.
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
        """Returns the arguments by their names; or prints the help and exits, if asked for.

        Beside them are ``command``, ``words``, and the names of the ``flags`` and of the ``positionals``.

        Raises:
            UsageError: for arguments that cannot be parsed.
        """
        if self.help_wanted:
            self.usage = f"{self.usage} [OPTIONS]"
            print(self.format_help(), end="", flush=True)  # noqa: T201 - print_help() hides that nothing was written
            self.exit()
        end = self.words.index("--") if "--" in self.words else len(self.words)
        try:
            found, rest = self.parse_known_args(list(self._spelled(self.words[:end])))
            self._read_without_flag(found, rest, self.words[end + 1 :])
        except argparse.ArgumentError as error:
            reason = error.message
            for theirs, ours in _MESSAGES.items():
                reason = reason.replace(theirs, ours)
            self._refuse(f"{error.argument_name} {reason}")
        found.flags, found.positionals = self.flags(), self._names_without_flag()
        return found

    def _spelled(self, words: Sequence[str]) -> Iterator[str]:
        """Yields the words as argparse takes them: flags with hyphens, and ``--scale=1 2`` as ``--scale 1 2``."""
        several = {text for action in self._actions if isinstance(action, Together) for text in action.option_strings}
        for word in words:
            name, equals, value = word.partition("=")
            if not word.startswith("--"):
                yield word
            elif equals and (spelled := name.replace("_", "-")) in several and not self._is_flag(value):
                yield from (spelled, value)
            else:
                yield f"{name.replace('_', '-')}{equals}{value}"

    def _read_without_flag(self, found: argparse.Namespace, rest: Sequence[str], last: Sequence[str]) -> None:
        """Reads the arguments without a flag from the words that argparse left, and from those after ``--``."""
        unknown = next(filter(self._is_flag, rest), None)
        if unknown is not None:
            self._refuse(self._unknown(unknown))
        given = [*rest, *last]
        if len(given) > len(self._without_flag):
            self._refuse(f"unexpected argument {shown(given[len(self._without_flag)])}")
        for (action, read), word in zip(self._without_flag, given, strict=False):
            _store(found, action, read, word)
        for action, _ in self._without_flag[len(given) :]:
            if action.default is REQUIRED:
                text = str(action.help).replace("%%", "%").rstrip(".")
                self._refuse(f"{action.metavar} must be given: {text[0].lower()}{text[1:]}")

    def _is_flag(self, word: str) -> bool:
        return len(word) > 1 and word[0] == "-" and not self._negative_number_matcher.match(word)

    def _unknown(self, word: str) -> str:
        """Returns the message for a flag that does not exist."""
        word = word.partition("=")[0]
        name = word.lstrip("-").replace("-", "_")
        if name in self._names_without_flag():
            return f"unknown option {shown(word)[1:-1]} ({name} is given without a flag)"
        found = meant(name, self.flags())
        return f"unknown option {shown(word)[1:-1]}" + (f" (did you mean {flag(found)}?)" if found else "")

    def _refuse(self, reason: str) -> NoReturn:
        raise UsageError(f"{reason}; see {self.prog} --help") from None

    def _names_without_flag(self) -> list[str]:
        return [str(action.metavar).lower() for action, _ in self._without_flag]

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
        _store(namespace, self, self._read, words)


class _Help(argparse.HelpFormatter):
    def _split_lines(self, text: str, width: int) -> list[str]:
        return textwrap.wrap(" ".join(text.split()), width, break_on_hyphens=False)


def _help(text: str, default: Any = None) -> str:
    """Returns a help text with its default, of which argparse must not format the percent signs."""
    if default is not None and default is not REQUIRED:
        text += f" (default: {default})"
    return text.replace("%", "%%")


def _store(namespace: argparse.Namespace, action: argparse.Action, read: Callable[[Any], Any], words: Any) -> None:
    """Stores the value of an argument, as argparse does for its own."""
    try:
        setattr(namespace, action.dest, read(words))
    except argparse.ArgumentTypeError as error:
        raise argparse.ArgumentError(action, str(error)) from None

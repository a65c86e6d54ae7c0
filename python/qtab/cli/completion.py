"""``qtab completion``: a script with which a shell completes commands, flags, choices and ids of environments.

tyro writes such scripts for one parser (``qtab train --tyro-print-completion bash``). But a shell looks a script up by
the first word of a line, and that is ``qtab`` for all of these parsers.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated

import tyro

from qtab._utils.progress import print_above
from qtab.cli.command import SUBCOMMANDS
from qtab.cli.constructors import constructor, read_choice
from qtab.cli.parsing import arguments_of, parse
from qtab.cli.usage import flag
from qtab.config import DEFAULTS
from qtab.config.choices import CHOICES
from qtab.envs.registry import ENTRIES

COMMAND = "qtab completion"
SHELLS = ("bash", "zsh")

_SCRIPT = """\
# Completion of qtab for {shell}. {advice}
{prelude}_qtab() {{
    local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} words=
    COMPREPLY=()
    if [ "$COMP_CWORD" -eq 1 ]; then
        words={commands}
    else
        case "${{COMP_WORDS[1]}} $prev" in
{choices}
        *)
            case "${{COMP_WORDS[1]}} $cur" in
{flags}
            *)
                case "${{COMP_WORDS[1]}} $prev" in
                *' -'*) ;;
{words}
                esac ;;
            esac ;;
        esac
    fi
    COMPREPLY=($(compgen -W "$words" -- "$cur"))
}}
complete -o default -F _qtab qtab
"""
_ADVICE = {
    "bash": """To ~/.bashrc: eval "$(qtab completion bash)\"""",
    "zsh": """To ~/.zshrc: eval "$(qtab completion zsh)\"""",
}
_PRELUDE = {"bash": "", "zsh": "autoload -U +X compinit && compinit\nautoload -U +X bashcompinit && bashcompinit\n"}


@dataclass(frozen=True)
class Arguments:
    """Print the script with which a shell completes qtab's commands, flags, choices and ids of environments."""

    shell: Annotated[
        tyro.conf.Positional[str],
        tyro.conf.arg(metavar="SHELL"),
        constructor("SHELL", 1, lambda words: read_choice(words, SHELLS)),
    ]
    """The shell that reads it: bash or zsh."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    print_above(script(parse(Arguments, COMMAND, arguments).shell).rstrip())
    return 0


def script(shell: str) -> str:
    """Returns the script for ``bash`` or ``zsh``."""
    commands = {name: _arguments(name) for name in SUBCOMMANDS}
    flags = {name: sorted([*map(flag, found), "--help"]) for name, (found, _) in commands.items()}
    first = {name: tuple(ENTRIES) for name, (_, positional) in commands.items() if "env" in positional}
    first["completion"] = SHELLS
    choices = {**CHOICES, "env": tuple(ENTRIES)}
    return _SCRIPT.format(
        shell=shell,
        advice=_ADVICE[shell],
        prelude=_PRELUDE[shell],
        commands=_quoted([*SUBCOMMANDS, "--help", "--version"]),
        choices="\n".join(
            f"        'train {flag(name)}') words={_quoted(words)} ;;" for name, words in choices.items()
        ),
        flags="\n".join(f"            '{name} -'*) words={_quoted(words)} ;;" for name, words in flags.items()),
        words="\n".join(f"                '{name} '*) words={_quoted(words)} ;;" for name, words in first.items()),
    )


def _arguments(command: str) -> tuple[set[str], set[str]]:
    """The names of the flags and of the positional arguments of a command."""
    if command != "train":
        kind = getattr(import_module(f"qtab.cli.{command}"), "Arguments", None)
        return (set(), set()) if kind is None else arguments_of(kind)
    from qtab.cli.train_arguments import Arguments as TrainArguments

    flags, _ = arguments_of(TrainArguments)
    return flags | DEFAULTS.keys(), {"env"}


def _quoted(words: Iterable[str]) -> str:
    return f"'{' '.join(words)}'"

"""Print the script that completes qtab's commands, flags, choices and ids of environments in a shell."""

from argparse import Namespace
from collections.abc import Iterable, Mapping

from qtab._utils.progress import print_above
from qtab.cli.command import SUBCOMMANDS, parser_of
from qtab.cli.parser import Parser
from qtab.cli.values import choice
from qtab.config.choices import CHOICES
from qtab.envs.registry import ENTRIES

SHELLS = ("bash", "zsh")

_SCRIPT = """\
# Completion of qtab for {shell}. To ~/.{shell}rc: eval "$(qtab completion {shell})"
{prelude}_qtab() {{
    local cur=${{COMP_WORDS[COMP_CWORD]}} words=
    if [ "$COMP_CWORD" -eq 1 ]; then
        words='{commands}'
    else
        case "${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD-1]}} $cur" in
{cases}
        esac
    fi
    COMPREPLY=($(compgen -W "$words" -- "$cur"))
}}
complete -o default -F _qtab qtab
"""
_PRELUDE = {"bash": "", "zsh": "autoload -U +X compinit && compinit\nautoload -U +X bashcompinit && bashcompinit\n"}


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    parser.positional("shell", "bash or zsh.", choice(SHELLS))


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    print_above(script(options.shell).rstrip())
    return 0


def script(shell: str) -> str:
    """Returns the script for ``bash`` or ``zsh``."""
    words: Mapping[str, Iterable[str]] = {**CHOICES, "env": ENTRIES, "env_flag": ENTRIES, "shell": SHELLS}
    # The cases are the command, the previous word and the word to complete; the first match counts.
    values, flags, others = [], [], []
    for command in SUBCOMMANDS:
        actions = parser_of(command)._actions
        flags.append((f"'{command} '*' -'*", [name for action in actions for name in action.option_strings]))
        for action in (action for action in actions if action.dest in words):
            values += [(f"'{command} {name} '*", words[action.dest]) for name in action.option_strings]
            others += [] if action.option_strings else [(f"'{command} '*", words[action.dest])]
    cases = [*values, *flags, ("*' -'*", ()), *others]
    return _SCRIPT.format(
        shell=shell,
        prelude=_PRELUDE[shell],
        commands=" ".join([*SUBCOMMANDS, "--help", "--version"]),
        cases="\n".join(f"        {pattern}) words='{' '.join(found)}' ;;" for pattern, found in cases),
    )

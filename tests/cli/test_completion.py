"""The script of ``qtab completion``: bash completes commands, flags, choices and ids of environments with it."""

import shutil
import subprocess
from pathlib import Path

import pytest

from qtab.cli.command import SUBCOMMANDS
from qtab.cli.commands.completion import script
from qtab.config import DEFAULTS
from support.processes.command import qtab_here, refused

LINES = {
    "tr": "train",
    "res": "resume",
    "--v": "--version",
    "train --epi": "--episodes",
    "train --learning-rate-sch": "--learning-rate-schedule",
    "train --qu": "--quiet",
    "train --algorithm dyna": "dyna_q dyna_q_plus",
    "train --env Cart": "CartPole-v0 CartPole-v1",
    "train Tax": "Taxi-v4",
    "train --seed 0 Tax": "Taxi-v4",
    "train --save Tax": "",
    "resume run.npz --ep": "--episodes",
    "resume run": "",
    "optimum Frozen": "FrozenLake-v1 FrozenLake8x8-v1",
    "diagnose --w": "--what-if",
    "bench --r": "--rounds",
    "completion z": "zsh",
    "fly --e": "",
}


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_bash_completes(tmp_path: Path) -> None:
    done = qtab_here("completion", "bash", cwd=tmp_path)
    assert done.returncode == 0, done
    calls = "\n".join(
        f'COMP_WORDS=(qtab {line}); COMP_CWORD={len(line.split())}; _qtab; echo "${{COMPREPLY[*]}}"' for line in LINES
    )
    shell = subprocess.run(
        ["bash", "--norc", "-uc", f"{done.stdout}\n{calls}\ncomplete -p qtab"],
        capture_output=True,
        text=True,
        check=True,
    )
    *answers, registered = shell.stdout.split("\n")[:-1]
    assert dict(zip(LINES, answers, strict=True)) == LINES
    assert registered == "complete -o default -F _qtab qtab"
    assert shell.stderr == ""


def test_every_command_and_every_setting_is_in_the_script() -> None:
    for shell in ("bash", "zsh"):
        text = script(shell)
        for name in SUBCOMMANDS:
            assert f"'{name} '*' -'*) words='" in text
        train = text.split("'train '*' -'*) words='")[1].split("'")[0].split()
        assert {f"--{name.replace('_', '-')}" for name in DEFAULTS} <= set(train)
    assert script("zsh").startswith("# Completion of qtab for zsh.")
    assert "bashcompinit" in script("zsh")


def test_another_shell_is_refused(tmp_path: Path) -> None:
    assert "SHELL must be one of bash, zsh, got 'fish'" in refused("completion", "fish", cwd=tmp_path)
    assert "SHELL must be given: bash or zsh;" in refused("completion", cwd=tmp_path)

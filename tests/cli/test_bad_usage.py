"""Bad usage is answered in one line that names the flag as it is typed; nothing prints a traceback."""

import sys
from pathlib import Path

import pytest

from qtab.cli import main
from qtab.cli.errors import as_flags
from support.processes.command import qtab, qtab_here, refused

FILES = {
    "deep.toml": "actions = " + "[" * 5000 + "]" * 5000,
    "digits.toml": "episodes = 1" + "0" * 5000,
    "ragged.toml": "initial_q = [[1, 2], [3]]",
    "actions.toml": "actions = [[1, [2]], 3]",
    "config.toml": "config = []",
    "table.toml": "[episodes]\nn = 1",
    "infinite.toml": "learning_rate = 1e999",
    "twice.toml": "seed = 1\nseed = 2",
    "rate.toml": "learning_rate = 3.0",
    "mixed.toml": "min_epsilon = 0.9",
}
REFUSED: list[tuple[str, str]] = [
    ("train --config deep.toml", "--config must be a TOML file, got 'deep.toml': it is nested too deeply"),
    ("train --config digits.toml", "--config must be a TOML file, got 'digits.toml': "),
    ("train --config ragged.toml", "ragged.toml: initial_q must be a table of numbers, got [[1, 2], [3]]"),
    ("train --config actions.toml", "actions must be a finite number, got [2]"),
    ("train --config config.toml", "config.toml: unknown setting 'config'"),
    ("train --config table.toml", "episodes must be an integer of at least 1, got {'n': 1}"),
    ("train --config infinite.toml", "learning_rate must be finite, got inf"),
    ("train --config twice.toml", "--config must be a TOML file, got 'twice.toml': "),
    ("train --config rate.toml", "learning_rate must lie in [0, 1], got 3.0"),
    ("train --config rate.toml --learning-rate 4", "--learning-rate must lie in [0, 1], got 4.0"),
    ("train --config mixed.toml --epsilon 0.5", "min_epsilon must lie in [0, --epsilon = 0.5], got 0.9"),
    ("train --config none.toml", "--config must be a file that can be read, got 'none.toml': No such file"),
    ("train --config .", "--config must be a file that can be read, got '.': Is a directory"),
    ("train --initial-q none.npz", "--initial-q must be a file that can be read, got 'none.npz': No such file"),
    (
        "train --learnig-rate 0.3",
        "unknown option --learnig-rate (did you mean --learning-rate?); see qtab train --help",
    ),
    ("train --alpha=0.3", "unknown option --alpha (did you mean --learning-rate?)"),
    ("train --savee run.npz", "unknown option --savee (did you mean --save?)"),
    ("train Taxi-v4 B", "unexpected argument 'B'"),
    ("train --episodes", "--episodes needs a value"),
    ("train --quiet=3", "--quiet takes no value, got '3'"),
    ("train --watch x", "--watch must be an integer, got 'x'"),
    ("train --watch 1 --record d", "--watch needs a display"),
    ("train --max-episode-steps 0", "--max-episode-steps must be an integer of at least 1, got 0"),
    ("train --trace-decay 0.5", "--trace-decay applies to --algorithm 'sarsa_lambda'"),
    ("train --tilings 3", "--tilings applies to --discretizer 'tiles', not to 'round', got 3"),
    ("train --actions " + "[" * 5000, "--actions must be a count or the actions themselves, got '[["),
    ("train --seed " + "9" * 5000, "--seed must be an integer, got '999"),
    ("verify none.npz", "RUN must be a file that can be read, got 'none.npz': No such file or directory"),
    ("verify", "RUN must be given: a file written by qtab train --save"),
    ("verify run.npz --episodes x", "--episodes must be an integer, got 'x'"),
    ("optimum --gamma 0.9", "unknown option --gamma (did you mean --discount?); see qtab optimum --help"),
    ("optimum --env Taxi-v4", "unknown option --env (env is given without a flag)"),
    ("optimum Taxi-v4 --discount 3", "--discount must lie in [0, 1], got 3.0"),
    ("optimum MountainCarContinuous-v0", "ENV must have a transition table"),
    ("train --env_flag Taxi-v4", "unknown option --env-flag (did you mean --env-kwargs?)"),
    ("train --scale=-x", "--scale must be a number, got '-x'"),
    ("completion --shell bash", "unknown option --shell (shell is given without a flag)"),
    ("sweep none.toml", "STUDY must be a file that can be read, got 'none.toml': No such file"),
    ("report .", "STORE must be a file, got the folder '.'"),
    ("playground --out none/page.html --no-open", "--out must be a file that can be written, got 'none/page.html'"),
    ("book 10.4 --runs x", "--runs must be an integer, got 'x'"),
    ("book 99", "NAME must be one of "),
    ("exercises sarza", "NAMES: there is no exercise 'sarza' (did you mean 'sarsa'?); `qtab exercises` lists them"),
    ("exercises sarsa --grade none", "--grade must be a folder of submissions, got 'none'"),
    ("exercises sarsa --out homework.txt", "--out must end in .ipynb or .py, got 'homework.txt'"),
    ("exercises --out homework.py", "NAMES must be given with --out or --grade; qtab exercises lists the names"),
    ("exercises sarsa --save marks.csv", "--grade must be given with --save or --reports"),
    ("bench --seconds x", "--seconds must be a number, got 'x'"),
    ("bench --part foo", "--part must be training, got 'foo'; python benchmarks/compare.py"),
]


@pytest.mark.parametrize(("line", "said"), REFUSED, ids=[line[:40] for line, _ in REFUSED])
def test_it_is_refused_in_one_line(tmp_path: Path, line: str, said: str) -> None:
    for name, text in FILES.items():
        if name in line:
            (tmp_path / name).write_text(text)
    command, *arguments = line.split()
    answer = refused(command, *arguments, cwd=tmp_path)
    assert answer.startswith(f"qtab {command}: error: {said}"), answer
    assert len(answer) < 1000


def test_a_video_is_not_offered_where_it_was_asked_for(tmp_path: Path) -> None:
    both = refused("train", "--watch", "1", "--record", "d", cwd=tmp_path)
    assert both.endswith("leave out --watch: --record works without one")
    alone = refused("train", "--watch", "1", cwd=tmp_path)
    assert alone.endswith("--record FOLDER makes videos without one")


def test_an_unexpected_error_is_one_line_too(tmp_path: Path) -> None:
    (tmp_path / "odd.py").write_text(
        "import gymnasium as gym\n\n\nclass Odd(gym.Env):\n    def __init__(self):\n        {}['wheel']\n\n\n"
        "gym.register('Odd-v0', entry_point=Odd)\n"
    )
    done = qtab("train", "odd:Odd-v0", cwd=tmp_path, PYTHONPATH=str(tmp_path))
    assert done.returncode == 1
    assert done.stderr.startswith("qtab train: error: KeyError: 'wheel' (at ")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("message", "typed"),
    [
        ("episodes must be 3", "--episodes must be 3"),
        ("the last episodes must be seen", "the last episodes must be seen"),
        ("min_epsilon must lie in [0, epsilon = 1]", "--min-epsilon must lie in [0, --epsilon = 1]"),
        ("take low= and high=", "take --low and --high"),
        ("for algorithm 'sarsa', got 'episodes'", "for --algorithm 'sarsa', got 'episodes'"),
        ("max_episode_steps= sets another", "--max-episode-steps sets another"),
        ("got 'max_episode_steps'", "got 'max_episode_steps'"),
    ],
)
def test_arguments_are_spelled_as_flags_and_words_are_not(message: str, typed: str) -> None:
    names = ("episodes", "epsilon", "min_epsilon", "low", "high", "algorithm", "max_episode_steps")
    assert as_flags(message, names) == typed
    assert as_flags(message, ()) == message


@pytest.mark.parametrize(
    ("arguments", "verdict"),
    [
        (
            ["--seed", "0"],
            "Not solved: the last 100 training episodes -187.7; greedy policy -186.8 over 100 episodes, ",
        ),
        (
            ["--preset", "solved", "--seed", "0"],
            "Solved: the last 100 training episodes -100.9; greedy policy -98.69 over 100 episodes, thr",
        ),
        (["--seed", "0", "--episodes", "99"], "Not solved: the last 99 training episodes -200; greedy policy -200"),
        (["Pendulum-v1", "--episodes", "100", "--seed", "0"], None),
    ],
)
def test_train_says_whether_the_task_is_solved(tmp_path: Path, arguments: list[str], verdict: str | None) -> None:
    printed = qtab_here("train", *arguments, cwd=tmp_path).stdout.splitlines()
    found = [line for line in printed if line.startswith(("Solved", "Not solved"))]
    assert len(found) == (verdict is not None)
    assert all(line.startswith(str(verdict)) for line in found)
    if verdict and verdict.startswith("Not"):
        assert found[0].endswith("threshold -110; --preset solved reaches it")


@pytest.mark.parametrize("arguments", [["completion", "bash"], ["trian"]])
def test_closed_streams_count_as_empty(arguments: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    monkeypatch.setattr(sys, "stderr", None)
    assert main(arguments) == (2 if arguments == ["trian"] else 0)
    sys.stdout.close()
    sys.stderr.close()

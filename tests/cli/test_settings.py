"""The settings as flags: explained and checked as in the API; flags that are not given have no effect."""

from pathlib import Path

import pytest

from qtab.cli.command import parser_of
from qtab.cli.commands import train
from qtab.cli.commands.train import env_and_settings
from qtab.cli.errors import UsageError
from qtab.config.help import explanations
from support.processes.command import qtab_here


def help_of(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    with pytest.raises(SystemExit) as leaving:
        parser_of("train", [*arguments, "--help"]).read()
    assert not leaving.value.code
    return " ".join(capsys.readouterr().out.split())


@pytest.fixture(autouse=True)
def wide(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")


def test_help_has_the_explanations_of_the_api(capsys: pytest.CaptureFixture[str]) -> None:
    text = help_of(capsys)
    own = {"env", "edges", "actions", "action_mask", "initial_q"}
    assert [name for name, words in explanations().items() if name not in own and words not in text] == []
    for group in ("environment", "run", "learning", "exploration", "discretizer"):
        assert f"{group} options" in text


@pytest.mark.parametrize(
    ("arguments", "shown"),
    [
        ([], ["default: 0.8", "default: 10.0 100.0", "default: assign", "default: article", "default: 0.9"]),
        (["CartPole-v1"], ["default: 3 3 6 6", "default: -2.4 -2.0 -0.21 -2.0", "default: tuned"]),
        (["--env", "CartPole-v1", "--preset", "solved"], ["default: true_online_sarsa_lambda", "default: 16"]),
        (["--episodes", "77", "--initial-q", "a.npz"], ["default: 77", "default: a.npz"]),
        (["qtab/MaximizationBias-v0"], ["default: an array of shape (3, 10)"]),
        (["--no-such-flag"], ["default: 0.8"]),
        (["--discretizer", "fourier"], ["default: 0.001", "default: 3"]),
        (["--discretizer", "coarse", "--algorithm", "sarsa_lambda"], ["default: accumulating"]),
        (["--discretizer", "radial", "--algorithm", "actor_critic"], ["default: 0.005"]),
    ],
)
def test_help_shows_what_a_run_would_use(
    arguments: list[str], shown: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    text = help_of(capsys, *arguments)
    assert [words for words in shown if words not in text] == []


def test_only_the_flags_that_are_given_are_settings(tmp_path: Path) -> None:
    (tmp_path / "run.toml").write_text("episodes = 7\nseed = 1\ninitial_q = [[0.0, 1.0]]\n[env_kwargs]\nx = 1\n")
    words = ["Taxi-v4", "--config", str(tmp_path / "run.toml"), "--seed", "2", "--epsilon", "None"]
    env, settings = env_and_settings(parser_of("train", words).read())
    assert env == "Taxi-v4"
    assert settings.pop("initial_q").tolist() == [[0.0, 1.0]]
    assert settings == {"episodes": 7, "seed": 2, "epsilon": None, "env_kwargs": {"x": 1}}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--alpha", "0.1"], "unknown option --alpha (did you mean --learning-rate?)"),
        (["--n-episodes", "9"], "unknown option --n-episodes (did you mean --episodes?)"),
        (["--episdes", "9"], "unknown option --episdes (did you mean --episodes?)"),
        (["--ties", "frist"], "--ties must be one of first, random, got 'frist' (did you mean 'first'?)"),
        (["--epsilon", "much"], "--epsilon must be a number, got 'much'"),
        (["--n-steps", "1.5"], "--n-steps must be an integer, got '1.5'"),
        (["--tiles", "4", "x"], "--tiles must be an integer, got 'x'"),
        (["--low", "a"], "--low must be a number, got 'a'"),
        (["--initial-q", "1", "b"], "--initial-q must be a number, got 'b'"),
        (["--algorithm", "None"], "--algorithm must be one of q_learning, "),
        (["Taxi-v4", "--env", "CartPole-v1"], "env must be given once, got 'Taxi-v4' and 'CartPole-v1'"),
    ],
)
def test_a_bad_flag_is_named_with_what_fits(arguments: list[str], message: str) -> None:
    with pytest.raises(UsageError) as caught:
        train.run(parser_of("train", arguments).read())
    assert str(caught.value).startswith(message)


def test_the_values_of_a_preset_yield_to_a_flag(tmp_path: Path) -> None:
    done = qtab_here("train", "--algorithm", "n_step_sarsa", "--preset", "article", "--episodes", "2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = qtab_here("train", "--terminal-update", "assign", "--algorithm", "n_step_sarsa", cwd=tmp_path)
    assert done.stderr.startswith(
        "qtab train: error: --terminal-update must be 'target' for --algorithm 'n_step_sarsa'"
    )

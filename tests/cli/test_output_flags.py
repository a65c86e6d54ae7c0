"""``--json`` prints one strict JSON object, ``--quiet`` nothing but errors; without them the text is as before."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.cli.command import SUBCOMMANDS
from qtab.cli.reporting import json_text
from support.processes.command import qtab_here, refused, with_run
from support.repository import ROOT


def refuse(name: str) -> None:
    raise AssertionError(f"{name} is not JSON")


def printed(*arguments: str, cwd: Path, code: int = 0) -> dict[str, Any]:
    """The object that a command prints, read strictly: it is the only line, and has no NaN."""
    done = qtab_here(*arguments, "--json", cwd=cwd)
    assert done.returncode == code, done
    assert done.stdout.count("\n") == 1
    content: dict[str, Any] = json.loads(done.stdout, parse_constant=refuse)
    assert content["command"] == f"qtab {arguments[0]}"
    return content


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return with_run(tmp_path, epsilon=0.0, episodes=300)


def test_train_prints_what_it_trained(tmp_path: Path) -> None:
    content = printed("train", "--seed", "3", "--episodes", "250", "--save", "run.npz", cwd=tmp_path)
    run = qtab.load(tmp_path / "run.npz")
    assert (content["env"], content["seed"]) == ("MountainCar-v0", 3)
    assert qtab.Config(**content["settings"]) == run.config
    assert (content["completed"], content["episodes"]) == (True, 250)
    assert content["steps"] == run.episode_lengths.sum()
    assert content["final_return"] == run.episode_returns[-100:].mean()
    assert content["mean_return"] == run.episode_returns.mean()
    assert (content["threshold"], content["solved"]) == (-110.0, False)
    assert content["gap"]["label"] == "best known"
    assert content["gap"]["final"] == pytest.approx(-97.668 - content["final_return"])
    assert content["gap"]["greedy"] is None
    assert content["versions"] == run.versions
    assert content["files"] == {"save": "run.npz"}


def test_train_says_solved_and_the_gap_of_a_small_table(tmp_path: Path) -> None:
    content = printed("train", "FrozenLake-v1", "--preset", "solved", "--seed", "0", cwd=tmp_path)
    assert content["solved"] is True
    assert content["best_mean_return"] >= content["threshold"]
    run = qtab.train("FrozenLake-v1", preset="solved", seed=0)
    gap = qtab.optimum(run).gap(run)
    assert content["gap"] == {
        "label": "optimum",
        "optimum": gap.optimum,
        "final": gap.final,
        "greedy": gap.greedy,
        "greedy_return": gap.greedy_return,
        "attainable": gap.attainable,
        "standard_error": 0.0,
    }
    assert content["files"] == {}


def test_what_is_not_known_is_null(tmp_path: Path) -> None:
    content = printed("train", "Pendulum-v1", "--seed", "0", "--episodes", "3", cwd=tmp_path)
    assert [content[name] for name in ("threshold", "solved", "gap", "best_mean_return")] == [None] * 4


def test_an_array_of_initial_values_is_shown_by_its_shape(folder: Path) -> None:
    content = printed("train", "FrozenLake-v1", "--episodes", "2", "--initial-q", "run.npz", cwd=folder)
    assert content["settings"]["initial_q"] == {"shape": [16, 4]}


def test_text_has_the_verdict_and_the_gap(tmp_path: Path) -> None:
    text = qtab_here("train", "--seed", "0", "--episodes", "200", cwd=tmp_path).stdout
    found = "the last 100 training episodes -200; greedy policy -200 over 100 episodes, threshold -110"
    assert f"Not solved: {found}; --preset solved reaches it\n" in text
    assert "Best known -97.67, gap 102.3 over the last 100 episodes\n" in text
    other = qtab_here("train", "--episodes", "200", "--max-episode-steps", "300", cwd=tmp_path).stdout
    assert "Best known" not in other
    assert "Not known whether solved: Gymnasium's threshold of -110 holds for 200 steps, not for max_episode_" in other


def test_values_that_overflow_are_reported_and_nothing_is_saved(tmp_path: Path) -> None:
    steep = "--algorithm sarsa_lambda --traces accumulating --trace-decay 1 --discount 1 --learning-rate 2 --tilings 32"
    arguments = ("train", "--preset", "solved", "--seed", "0", *steep.split(), "--save", "run.npz")
    done = qtab_here(*arguments, "--json", cwd=tmp_path)
    assert done.returncode == 1
    content = json.loads(done.stdout, parse_constant=refuse)
    assert (content["completed"], content["files"]) == (False, {})
    first, second = done.stderr.splitlines()
    assert first.startswith("qtab train: error: this run cannot be saved")
    assert "the action values overflowed" in second


def test_the_other_commands_print_what_they_found(folder: Path) -> None:
    run = qtab.load(folder / "run.npz")
    verified = printed("verify", "run.npz", "--episodes", "20", cwd=folder)
    assert (verified["equal"], verified["episodes"], verified["episode"]) == (True, 20, None)
    best = printed("optimum", "FrozenLake-v1", cwd=folder)
    assert best["expected_return"] == qtab.optimum("FrozenLake-v1").expected_return
    assert (best["exact"], best["method"], best["reward_threshold"]) == (True, "finite_horizon", 0.7)
    explained = printed("explain", "run.npz", "--episode", "1", "--steps", "2", cwd=folder)
    steps = qtab.explain(run, 1, 2).steps
    assert [step["updates"][0]["error"] for step in explained["steps"]] == [step.td_error for step in steps]
    diagnosis = qtab.diagnose(run)
    content = printed("diagnose", "run.npz", cwd=folder)
    assert (content["solved"], content["what_if"]) == (False, None)
    assert [finding["name"] for finding in content["findings"]] == list(diagnosis.names)
    assert content["findings"][0]["evidence"] == dict(diagnosis.findings[0].evidence)


@pytest.mark.slow
def test_the_changes_that_were_tried_are_printed(folder: Path) -> None:
    tried = printed("diagnose", "run.npz", "--what-if", "--seeds", "3", cwd=folder)["what_if"]
    expected = qtab.diagnose(qtab.load(folder / "run.npz")).what_if(3)
    assert tried["seeds"] == [0, 1, 2]
    assert [result["change"] for result in tried["results"]] == [dict(trial.change) for trial in expected.results]
    assert tried["results"][0]["mean_return"] == expected.best.returns.mean()
    assert tried["results"][0]["difference"]["estimate"] == expected.best.comparison.difference.estimate  # type: ignore[union-attr]


def test_a_sweep_prints_its_ranking(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text(
        'env = "FrozenLake-v1"\nseeds = 3\n[grid]\nlearning_rate = [0.1, 0.5]\n[config]\nepisodes = 30\n'
    )
    content = printed("sweep", "s.toml", "--confirm", "2", cwd=tmp_path)
    sweep = qtab.load_sweep(tmp_path / "s.db")
    assert [row["setting"] for row in content["ranking"]] == sweep.ranking()
    assert content["ranking"][0]["values"] == sweep.settings[sweep.ranking()[0]]
    assert (content["runs"], content["failed"], content["store"]) == (6, 0, "s.db")
    assert content["confirmation"][0]["setting"] == sweep.ranking()[0]
    done = qtab_here("sweep", "s.toml", "--quiet", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize(
    "line",
    [
        "train --episodes 150 --save other.npz",
        "train CliffWalking --episodes 2",
        "resume run.npz --episodes 310",
        "verify run.npz --episodes 5",
        "diagnose run.npz",
        "explain run.npz",
        "optimum FrozenLake-v1",
    ],
)
def test_quiet_prints_nothing(folder: Path, line: str) -> None:
    done = qtab_here(*line.split(), "--quiet", cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("command", ["train", "verify run.npz", "diagnose run.npz", "optimum", "sweep s.toml"])
@pytest.mark.parametrize("flag", ["--json", "--quiet"])
def test_errors_are_one_line_on_standard_error(folder: Path, command: str, flag: str) -> None:
    (folder / "s.toml").write_text("")
    assert "unknown option --speed" in refused(*command.split(), "--speed", "3", flag, cwd=folder)
    assert "--json must be given without --quiet" in refused(*command.split(), "--json", "--quiet", cwd=folder)


def test_a_verification_that_fails_is_json_too(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = qtab.load(folder / "run.npz")
    vars(run)["episode_returns"] = run.episode_returns + 1.0
    monkeypatch.setattr("qtab.cli.saved_run.load", lambda _: run)
    content = printed("verify", "run.npz", "--episodes", "3", cwd=folder, code=1)
    assert content["equal"] is content["returns_equal"] is False


def test_numbers_that_json_does_not_have_become_null() -> None:
    value = {
        "a": [np.nan, -np.inf, np.float32(0.5), np.int64(3), np.array([1.0, np.inf])],
        "b": (None, True, Path("c")),
    }
    assert json_text(value) == '{"a": [null, null, 0.5, 3, [1.0, null]], "b": [null, true, "c"]}'


def test_the_page_on_the_command_line_lists_every_key(folder: Path) -> None:
    page = (ROOT / "docs" / "reference" / "command_line.md").read_text(encoding="utf-8")
    shared = page.split("| `qtab train` and `qtab resume` | |")[1].split("## Completion")[0]
    lines = {line.split("`")[1]: line for line in shared.splitlines() if line.startswith("| `")}
    described = {key for line in lines.values() for key in re.findall(r"`(\w+)`", line)}
    trained = printed("train", "FrozenLake-v1", "--episodes", "5", cwd=folder)
    assert {*trained, *trained["gap"]} <= described
    for line in ("verify run.npz --episodes 2", "explain run.npz", "diagnose run.npz", "optimum FrozenLake-v1"):
        name, *arguments = line.split()
        keys = set(re.findall(r"`(\w+)`", lines[name]))
        assert set(printed(name, *arguments, cwd=folder)) - {"command"} <= keys


def test_the_page_on_the_command_line_lists_every_command_and_those_without_the_flags(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "reference" / "command_line.md").read_text(encoding="utf-8")
    table = page.split("\n\n")[1]
    assert sorted(re.findall(r"`qtab (\w+)", table)) == sorted(SUBCOMMANDS)
    sentence = re.search(r"All commands except for (.*?) have both flags", page, re.DOTALL)
    assert sentence is not None
    without = [name for name in SUBCOMMANDS if "--json" not in qtab_here(name, "--help", cwd=tmp_path).stdout]
    assert sorted(re.findall(r"`(\w+)`", sentence[1])) == sorted(without)

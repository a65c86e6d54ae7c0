"""``qtab sweep`` and ``qtab report``."""

import csv
import html
import re
from typing import Any

import numpy as np
import pytest

import qtab
from qtab._utils.progress import ProgressBar
from qtab.cli import main
from qtab.rendering.sweep_report import report_page, settings_table

ENV = 'env = "MountainCar-v0"\n'
GRID = "[grid]\nepsilon = [0.3]\n"
STUDY = """
env = "MountainCar-v0"
seeds = 4
block = 10
[grid]
learning_rate = [0.1, 0.5]
scale = [[5, 50], [10, 100]]
[config]
episodes = 30
"""


@pytest.mark.slow
def test_a_study_is_swept_resumed_and_reported(tmp_path, capsys):
    study = tmp_path / "study.toml"
    study.write_text(STUDY)
    assert main(["sweep", str(study)]) == 0
    assert "16 runs of 4 settings" in capsys.readouterr().out
    assert main(["sweep", str(study)]) == 0
    loaded = qtab.load_sweep(tmp_path / "study.db")
    grid: dict[str, Any] = {"learning_rate": [0.1, 0.5], "scale": [(5, 50), (10, 100)]}
    direct = qtab.sweep("MountainCar-v0", grid, 4, block=10, episodes=30)
    for name, column in direct.columns.items():
        np.testing.assert_array_equal(loaded.columns[name], column, strict=True)

    assert main(["report", str(tmp_path / "study.db"), "--out", str(tmp_path / "report")]) == 0
    written = (tmp_path / "report" / "report.html").read_text()
    assert written.count("data:image/png;base64,") == 5
    assert not re.search(r'(src|href)="(?!data:)', written)
    with (tmp_path / "report" / "runs.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["mean_return"]) for row in rows] == direct.columns["mean_return"].tolist()
    with (tmp_path / "report" / "settings.csv").open() as file:
        means = [float(row["mean"]) for row in csv.DictReader(file)]
    assert means == sorted(means, reverse=True)


def test_a_design_can_be_swept(tmp_path, capsys):
    study = tmp_path / "study.toml"
    design = 'kind = "sobol"\npoints = 4\nspace.learning_rate = {low = 0.01, high = 1.0, log = true}'
    study.write_text(f"env = 'MountainCar-v0'\nseeds = [3, 5]\n[design]\n{design}\n[config]\nepisodes = 5\n")
    assert main(["sweep", str(study), "--store", str(tmp_path / "other.db"), "--threads", "1"]) == 0
    assert len(qtab.load_sweep(tmp_path / "other.db")) == 8


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("seeds = 3", "either a [grid] or a [design]"),
        ("nonsense = 3", "unknown key 'nonsense'; use env, seeds"),
        ("seed = 3", "unknown key 'seed' (did you mean 'seeds'?)"),
        ("[grid", "STUDY must be a TOML file"),
        ("[grid]\nepsilon = [0.3]", "env is missing"),
        (f"{ENV}[grid]\nepsilon = 0.3", "grid['epsilon'] must be a list of values"),
        (f"{ENV}[grid]\nepsilom = [0.3]", "unknown setting 'epsilom' (did you mean 'epsilon'?)"),
        (f"{ENV}[design]\nkind = 'spiral'\npoints = 3", "[design] must have kind"),
        (f"{ENV}[design]\npoint = 3", "unknown key 'point' in [design] (did you mean 'points'?)"),
        (f"{ENV}[design]\npoints = 4\nspace = 3", "design.space must be a table, [design.space], got 3"),
        (f"{ENV}[design]\npoints = 4\nspace.epsilon = 3", "design.space.epsilon must be a list of choices or {low"),
        (f"{ENV}[design]\npoints = 4\nspace.epsilon = {{low = 0.1}}", "design.space.epsilon must be a list of choices"),
        (f"{ENV}[design]\npoints = 3\nspace.epsilon = [0.1, 0.2]", "points must be a power of two"),
        (f"{ENV}design = 3", "design must be a table, [design], got 3"),
        (f"{ENV}grid = 3", "grid must be a table, [grid], got 3"),
        (f"{ENV}grid = [1]", "grid must be a table, [grid], got [1]"),
        (f"{ENV}config = []\n{GRID}", "config must be a table, [config], got []"),
        (f"{ENV}store = 3\n{GRID}", "store must be a string, got 3"),
        (f"env = 3\n{GRID}", "env must be a string, got 3"),
        (f"env = 'MountainCat-v0'\n{GRID}", "MountainCat"),
        (f"{ENV}{GRID}[config]\nthreads = 2", "threads must be before the first [table], not in [config]"),
        (f"{ENV}{GRID}[config]\nstore = 'x'", "store must be before the first [table]"),
        (f"{ENV}{GRID}[config]\nlearnig_rate = 1", "unknown setting 'learnig_rate' (did you mean 'learning_rate'?)"),
        (
            f"{ENV}{GRID}[config]\nepisodes = 100000000000",
            "runs of 100,000,000,000 episodes would take 3.09 TiB, more than",
        ),
        (f"{ENV}memory_limit = 1\n{GRID}", "more than memory_limit=1 "),
        (f"{ENV}seeds = 1000000000000\n{GRID}", "the results of 1,000,000,000,000 runs would take"),
        (f"{ENV}seeds = 'x'\n{GRID}", "seeds must be an integer or a sequence of integers, got 'x'"),
        (f"{ENV}block = 0\n{GRID}", "block must be an integer of at least 1, got 0"),
        ("x = " + "[" * 5000, "STUDY must be a TOML file"),
        ("\0", "STUDY must be a TOML file"),
    ],
)
def test_a_bad_study_is_refused_in_one_line(tmp_path, capsys, text, message):
    study = tmp_path / "study.toml"
    study.write_text(text)
    assert main(["sweep", str(study)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert message in said
    assert str(study) in said
    assert sorted(tmp_path.iterdir()) == [study]


def test_files_that_are_not_stores_are_refused(tmp_path, capsys):
    assert main(["report", str(tmp_path / "none.db")]) == 2
    (tmp_path / "x.db").write_text("x" * 5000)
    assert main(["report", str(tmp_path / "x.db")]) == 2
    assert "not a sweep store" in capsys.readouterr().err


def test_the_best_setting_is_confirmed_with_other_seeds(tmp_path, capsys):
    study = tmp_path / "study.toml"
    study.write_text(STUDY)
    confirmed = tmp_path / "confirmed.db"
    arguments = ["sweep", str(study), "--confirm", "3", "--top", "2", "--confirm-store", str(confirmed)]
    assert main(arguments) == 0
    lines = capsys.readouterr().out.splitlines()
    best = qtab.load_sweep(tmp_path / "study.db").ranking()[:2]
    assert [line.split()[1] for line in lines[1:]] == [str(setting) for setting in best]
    assert all("over 3 other seeds; " in line for line in lines[1:])
    assert qtab.load_sweep(confirmed).seeds == (4, 5, 6)
    assert main(["sweep", str(study), "--confirm", "0"]) == 2


@pytest.mark.slow
def test_a_report_says_how_it_was_made_and_what_it_leaves_out(tmp_path):
    study = tmp_path / "study.toml"
    rates = [0.1 * (1 + index) for index in range(9)]
    study.write_text(f"{ENV}seeds = 2\nblock = 10\n[grid]\nlearning_rate = {rates}\n[config]\nepisodes = 20\n")
    assert main(["sweep", str(study)]) == 0
    store, out = tmp_path / "study.db", tmp_path / "my report"
    assert main(["report", str(store), "--out", str(out)]) == 0
    written = html.unescape((out / "report.html").read_text())
    assert f"qtab report {store} --out '{out}'" in written
    assert "The best of 9 settings looks better than it is" in written
    assert "sweep.confirm(seeds=100) in Python, or qtab sweep with --confirm 100" in written
    assert "The pictures show the best 8 of 9 settings; the table has all of them." in written
    alternatives = re.findall(r'<img alt="([^"]*)"', written)
    assert len(alternatives) == 4
    assert all(text.endswith(".") and len(text) > 60 for text in alternatives)
    assert "Learning curves of the best 8 of 9 settings: the mean return of each 10 episodes." in alternatives[2]
    assert "A line marks the reward threshold, -110. A line marks the best known, -97.668." in alternatives[2]
    for name, value in {"algorithm": "q_learning", "episodes": 20, "seeds": "0, 1", "qtab": qtab.__version__}.items():
        assert re.search(rf"<t[hd][^>]*>{name}</t[hd]><td>{value}</td>", written), name
    assert re.search(r'<th scope="row">training</th><td>[\d.]+ s, summed over', written)
    with (out / "settings.csv").open() as file:
        assert len(list(csv.DictReader(file))) == 9


def test_a_report_counts_failed_runs():
    steep: dict[str, Any] = {"discretizer": "tiles", "algorithm": "sarsa_lambda", "traces": "accumulating"}
    steep |= {"trace_decay": 1.0, "discount": 1.0, "epsilon": 0.8, "min_epsilon": 0.8, "episodes": 4}
    sweep = qtab.sweep("MountainCar-v0", {"learning_rate": [0.1, 1.5]}, seeds=2, **steep)
    header, rows = settings_table(sweep)
    counted = {row[0]: dict(zip(header, row, strict=True)) for row in rows}
    assert [(counted[setting]["runs"], counted[setting]["failed"]) for setting in (0, 1)] == [(2, 0), (1, 1)]
    assert (counted[1]["low"], counted[1]["high"]) == (None, None)  # one run has no interval
    assert counted[1]["ranked_mean"] == sweep.mean_final_returns()[1] <= counted[1]["mean"]
    text = report_page(sweep, header, rows, {}, None)
    assert "2 seeds each, 1 failed" in text
    assert "a failed run counts as the worst run of the sweep" in text


@pytest.mark.parametrize("name", ["none.toml", "."])
def test_a_study_that_cannot_be_read_is_an_error_without_a_number(tmp_path, capsys, name):
    assert main(["sweep", str(tmp_path / name)]) == 2
    said = capsys.readouterr().err
    assert "STUDY must be a file that can be read, got" in said
    assert "Errno" not in said


def test_an_interrupted_sweep_says_what_is_kept(tmp_path, capsys, monkeypatch, small_chunks):
    study = tmp_path / "study.toml"
    study.write_text(STUDY)

    def interrupt(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(ProgressBar, "move_to", interrupt)
    assert main(["sweep", str(study)]) == 130
    kept = len(qtab.load_sweep(tmp_path / "study.db"))
    assert 0 < kept < 16
    said = capsys.readouterr().out
    assert said.startswith(f"interrupted: kept {kept} run")
    assert said.endswith(f"in {tmp_path / 'study.db'}; the same command resumes\n")
    monkeypatch.undo()
    assert main(["sweep", str(study)]) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("--top 5 --confirm 3", "--top must be an integer from 1 to 4, got 5"),
        ("--top 0 --confirm 3", "--top must be an integer from 1 to 4, got 0"),
        ("--confirm 0", "--confirm must be an integer from 1 to 10000000, got 0"),
        ("--confirm 10000001", "--confirm must be an integer from 1 to 10000000, got 10000001"),
        ("--per algorithm --confirm 3", "--per must be one of 'learning_rate', 'scale', got 'algorithm'"),
        ("--confirm 3 --confirm-store study.db", "--confirm-store must be another file than the store of the sweep, "),
        ("--confirm 3 --confirm-store ./other/../study.db", "--confirm-store must be another file than the store"),
        (
            "--confirm 3 --confirm-store none/c.db",
            "--confirm-store must be a file that can be written, got 'none/c.db'",
        ),
        ("--confirm 3 --confirm-store study.toml", "store '"),
        ("--confirm 3 --confirm-store .", "store must be a file, got the folder '.'"),
        ("--top 2", "--top needs --confirm, the number of seeds"),
        ("--per scale", "--per needs --confirm, the number of seeds"),
        ("--confirm-store c.db", "--confirm-store needs --confirm, the number of seeds"),
    ],
)
def test_what_cannot_be_confirmed_is_refused_before_the_sweep(tmp_path, capsys, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "other").mkdir()
    (tmp_path / "study.toml").write_text(STUDY)
    assert main(["sweep", "study.toml", *arguments.split()]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"qtab sweep: error: {message}"), said
    assert said.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other", "study.toml"]


def test_the_best_for_each_value_are_confirmed_without_scipy(tmp_path, capsys, monkeypatch):
    study = tmp_path / "study.toml"
    study.write_text(STUDY)

    def missing(*_: Any) -> None:
        raise ModuleNotFoundError("No module named 'scipy'", name="scipy")

    monkeypatch.setattr(qtab.Confirmation, "mean", missing)
    assert main(["sweep", str(study), "--confirm", "2", "--per", "scale"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3
    assert all(
        re.fullmatch(r"setting \d \(.*\): -\d+ over 2 other seeds; -\d+ in the sweep", line) for line in lines[1:]
    )

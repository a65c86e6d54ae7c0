"""A store holds the versions that trained each run, and results say where these differ or are not known."""

import json
import logging
import shutil
import sqlite3
from concurrent.futures import Executor, Future
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

import qtab
from qtab._utils.versions import versions
from qtab.cli import main
from qtab.rendering.sweep_report import report_page
from qtab.sweeps import store as store_module
from qtab.sweeps import worker
from support.files.damage import execute
from support.sweeps import assert_equal

LAKE = "FrozenLake-v1"
GRID = {"learning_rate": [0.1, 0.2]}
SHORT: dict[str, Any] = {"episodes": 20, "progress": False}
SAVED = Path(__file__).parents[2] / "results" / "files" / "saved"
OTHERS = {**versions(), "numpy": "9.9.9"}
HERE = versions()["numpy"]
NOTE = f"The runs were trained with different versions: numpy {HERE} (4 runs), 9.9.9 (2 runs)."


@pytest.fixture
def mixed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A store whose third seed was trained with another version of NumPy."""
    path = tmp_path / "mixed.db"
    qtab.sweep(LAKE, GRID, 2, store=path, **SHORT)
    with monkeypatch.context() as patch:
        patch.setattr(store_module, "versions_here", lambda: OTHERS)
        qtab.sweep(LAKE, GRID, 3, store=path, **SHORT)
    return path


def test_each_run_has_its_versions_even_after_more_seeds_were_added(mixed: Path) -> None:
    expected = [versions(), versions(), OTHERS] * 2
    assert list(qtab.load_sweep(mixed).run_versions) == expected
    table = qtab.sweep(LAKE, GRID, 4, store=mixed, **SHORT)
    assert list(table.run_versions) == [versions(), versions(), OTHERS, versions()] * 2


def test_results_say_which_versions_differ(mixed: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "qtab"):
        table = qtab.load_sweep(mixed)
    assert NOTE in caplog.text
    assert repr(table) == "<Sweep of FrozenLake-v1: 2 settings, 6 runs, 0 failed, different versions>"
    assert NOTE in table._repr_html_()
    written = report_page(table, ["setting"], [[0], [1]], {}, None)
    assert NOTE in written
    assert f"<td>{HERE} (4 runs), 9.9.9 (2 runs)</td>" in written
    assert f"<td>{qtab.__version__}</td>" in written
    confirmation = table.confirm(2, threads=1, progress=False)
    assert f"numpy {HERE} (6 runs), 9.9.9 (2 runs)" in str(confirmation)
    assert f"numpy {HERE} (6 runs), 9.9.9 (2 runs)" in confirmation._repr_html_()


def test_results_of_one_version_say_nothing(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    qtab.sweep(LAKE, GRID, 2, store=tmp_path / "one.db", **SHORT)
    with caplog.at_level(logging.WARNING, "qtab"):
        table = qtab.load_sweep(tmp_path / "one.db")
    assert not caplog.messages
    for text in (repr(table), table._repr_html_(), str(table.confirm(2, threads=1, progress=False))):
        assert "version" not in text


def test_the_command_prints_the_versions(tmp_path: Path, mixed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study = tmp_path / "mixed.toml"
    study.write_text(f'env = "{LAKE}"\nseeds = 3\n[grid]\nlearning_rate = [0.1, 0.2]\n[config]\nepisodes = 20\n')
    assert main(["sweep", str(study)]) == 0
    assert NOTE in capsys.readouterr().out
    assert main(["sweep", str(study), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["versions"] == [{"runs": 4, "versions": versions()}, {"runs": 2, "versions": OTHERS}]


class InAnotherVersion:
    """An executor whose worker has another version of NumPy."""

    def submit(self, function: Any, *arguments: Any) -> Any:
        future: Any = Future()
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(worker, "versions", lambda: OTHERS)
            future.set_result(function(*arguments))
        return future


def test_the_versions_are_those_of_the_worker_that_trained_the_run() -> None:
    executor: Executor = InAnotherVersion()  # type: ignore[assignment]
    table = qtab.sweep(LAKE, GRID, 2, executor=executor, **SHORT)
    assert list(table.run_versions) == [OTHERS] * 4


def test_a_run_that_is_different_here_names_the_versions_that_trained_it(mixed: Path) -> None:
    table = qtab.load_sweep(mixed)
    table.columns["steps"][2] += 1
    with pytest.raises(ValueError, match=r"in the sweep \d+\.0, which was trained with numpy 9\.9\.9"):
        table.run(0, 2)


def test_a_store_of_version_2_loads_and_says_that_the_versions_of_its_runs_are_unknown(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "study.db"
    shutil.copy(SAVED / "version_2.db", path)
    note = "An earlier version of qtab stored 6 runs without the versions that trained them."
    with caplog.at_level(logging.WARNING, "qtab"):
        table = qtab.load_sweep(path)
    assert note in caplog.text
    assert list(table.run_versions) == [None] * 6
    assert note in table._repr_html_()
    written = report_page(table, ["setting"], [[0], [1]], {}, None)
    assert note in written
    assert "<td>unknown</td>" in written
    more = qtab.sweep(LAKE, GRID, 4, store=path, **SHORT)
    assert list(more.run_versions) == [None, None, None, versions()] * 2
    assert_equal(more, qtab.sweep(LAKE, GRID, 4, **SHORT))


def test_a_process_of_an_earlier_version_cannot_store_runs_after_an_upgrade(tmp_path: Path) -> None:
    path = tmp_path / "study.db"
    shutil.copy(SAVED / "version_2.db", path)
    with closing(sqlite3.connect(path, isolation_level=None)) as earlier:
        assert earlier.execute("SELECT count(*) FROM chunks").fetchone()[0]  # it has checked the version
        qtab.sweep(LAKE, GRID, 4, store=path, **SHORT)
        earlier.execute("DELETE FROM chunks")
        with pytest.raises(sqlite3.IntegrityError, match="needs_newer_qtab"):
            earlier.execute("INSERT INTO chunks (start, stop, seconds, digest) VALUES (0, 6, 1.0, 'x')")


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("UPDATE chunks SET versions = 1", "differ from their digest"),
        ("UPDATE chunks SET versions = 'x'", "has no versions"),
        ("UPDATE meta SET value = '{}' WHERE name = 'versions'", "differs from its digest"),
    ],
)
def test_damaged_versions_are_refused(tmp_path: Path, statement: str, message: str) -> None:
    path = tmp_path / "study.db"
    qtab.sweep(LAKE, GRID, 2, store=path, **SHORT)
    execute(path, statement)
    with pytest.raises(qtab.StoreError, match=message):
        qtab.load_sweep(path)

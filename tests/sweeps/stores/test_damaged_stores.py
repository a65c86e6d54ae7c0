"""A damaged store raises StoreError, or gives the results of the undamaged one. It never gives other results.

By hand, with 1,000 damaged stores: ``pytest tests/sweeps/stores/test_damaged_stores.py --hypothesis-profile fuzz``.
"""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings

import qtab
from qtab.cli import main
from qtab.sweeps import worker
from support.files.damage import DAMAGE, NESTED, STATEMENTS, Damage, execute
from support.sweeps import assert_equal

LAKE = "FrozenLake-v1"
GRID: dict[str, Any] = {"learning_rate": [0.1, 0.2], "algorithm": ["sarsa", "q_learning"]}
SMALL: dict[str, Any] = {"seeds": 3, "episodes": 20, "block": 5}
SAVED = Path(__file__).parents[2] / "results" / "files" / "saved"
GRID_2: dict[str, Any] = {"learning_rate": [0.1, 0.2]}
"""The grid of the saved store of version 2."""


class Stores:
    """A finished and an unfinished store, and the table of both."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.table = qtab.sweep(LAKE, GRID, **SMALL)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(worker, "MAX_CHUNK_RUNS", 4)
            qtab.sweep(LAKE, GRID, store=folder / "finished.db", **SMALL)
            with pytest.raises(KeyboardInterrupt):
                qtab.sweep(LAKE, GRID, store=folder / "unfinished.db", callback=self._interrupt, **SMALL)

    @staticmethod
    def _interrupt(progress: qtab.SweepProgress) -> None:
        if progress.runs > 5:
            raise KeyboardInterrupt

    def check_load(self, path: Path, runs: int) -> bool:
        """Loads a store, which must hold the results of the first runs; returns whether it was refused."""
        loaded = refused_or_result(path, lambda: qtab.load_sweep(path))
        if loaded is None:
            return True
        assert len(loaded) == runs
        for name in ("setting", "learning_rate", "algorithm", "seed", "steps", "final_return", "best_return", "error"):
            assert loaded.columns[name].tolist() == self.table.columns[name][:runs].tolist(), name
        assert list(loaded._curves) == list(self.table._curves)[:runs]
        return False

    def check_resume(self, path: Path) -> bool:
        """Resumes a sweep; returns whether its store was refused."""
        table = refused_or_result(path, lambda: qtab.sweep(LAKE, GRID, store=path, **SMALL))
        if table is not None:
            assert_equal(table, self.table)
        return table is None


def refused_or_result(path: Path, call: Callable[[], qtab.Sweep]) -> qtab.Sweep | None:
    """Returns the result of a call; None if it raised StoreError. Any other error is raised."""
    try:
        return call()
    except qtab.StoreError as error:
        message = str(error)
    assert str(path) in message
    assert "\n" not in message
    return None


@pytest.fixture(scope="module")
def stores(tmp_path_factory: pytest.TempPathFactory) -> Stores:
    return Stores(tmp_path_factory.mktemp("stores"))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["finished", "unfinished"])
@settings(max_examples=settings().max_examples // 5)
@given(damage=DAMAGE)
def test_a_damaged_store_is_refused_or_gives_the_same_results(stores: Stores, name: str, damage: Damage) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "study.db"
        shutil.copy(stores.folder / f"{name}.db", path)
        found = len(qtab.load_sweep(path))
        damage(path)
        is_empty = path.stat().st_size == 0
        refused = stores.check_load(path, found)
        # A sweep begins anew in an empty file, which holds no results to load.
        assert stores.check_resume(path) == (refused and not is_empty)


@pytest.mark.slow
@settings(max_examples=settings().max_examples // 10)
@given(damage=DAMAGE)
def test_a_damaged_store_of_an_earlier_version_raises_no_other_error(damage: Damage) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "study.db"
        shutil.copy(SAVED / "version_2.db", path)
        damage(path)
        refused_or_result(path, lambda: qtab.load_sweep(path))
        refused_or_result(path, lambda: qtab.sweep(LAKE, GRID_2, store=path, seeds=3, episodes=20))


@pytest.mark.parametrize("statement", STATEMENTS)
def test_a_store_with_other_rows_or_tables_is_refused(stores: Stores, tmp_path: Path, statement: str) -> None:
    path = tmp_path / "study.db"
    shutil.copy(stores.folder / "finished.db", path)
    execute(path, statement)
    assert stores.check_load(path, 12)
    assert stores.check_resume(path)
    assert main(["report", str(path), "--out", str(tmp_path / "report")]) == 2
    assert not (tmp_path / "report").exists()


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("DELETE FROM runs WHERE run = 3", "runs are missing among 2 to 5"),
        ("INSERT INTO runs (run, seed, curve) VALUES (6, '0', x'')", "a run 6, but its study has 6 runs"),
        ("UPDATE runs SET best_return = 9e999 WHERE run = 3", "run 3: its results are not finite"),
        ("UPDATE runs SET steps = 3 WHERE run = 3", "run 3: 20 episodes of at most 100 steps cannot have 3 steps"),
        ("UPDATE runs SET episodes = 21 WHERE run = 3", "run 3: it has 20 episodes, not 21"),
        ("UPDATE runs SET terminated_rate = 2 WHERE run = 3", "run 3: its terminated_rate is 2"),
        ("UPDATE runs SET mean_return = 2 WHERE run = 3", "run 3: its mean, final and best return contradict"),
        ("UPDATE runs SET curve = x'00' WHERE run = 3", "run 3: its learning curve has 1 bytes"),
        ("UPDATE runs SET error = 'no' WHERE run = 3", "run 3: it failed, but has results"),
        ("UPDATE runs SET seed = '7' WHERE run = 3", "run 3: its seed is 0, not '7'"),
        ("UPDATE chunks SET start = 1 WHERE start = 0", "runs are missing among 1 to 1"),
        ("UPDATE chunks SET digest = NULL", "it has a run 0 that belongs to none of its finished chunks"),
    ],
)
def test_the_meaning_of_a_store_of_an_earlier_version_is_checked(tmp_path: Path, statement: str, message: str) -> None:
    path = tmp_path / "study.db"
    shutil.copy(SAVED / "version_2.db", path)
    execute(path, statement)
    with pytest.raises(qtab.StoreError, match=message):
        qtab.load_sweep(path)
    with pytest.raises(qtab.StoreError, match=message):
        qtab.sweep(LAKE, GRID_2, store=path, seeds=3, episodes=20)


def test_a_store_of_version_1_is_refused_and_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "study.db"
    shutil.copy(SAVED / "version_1.db", path)
    content = path.read_bytes()
    message = "study.db' has format version '1', but this qtab reads 2 and 3"
    with pytest.raises(qtab.StoreError, match=message):
        qtab.load_sweep(path)
    with pytest.raises(qtab.StoreError, match=message):
        qtab.sweep(LAKE, GRID, store=path, seeds=3, episodes=20)
    assert main(["report", str(path), "--out", str(tmp_path / "report")]) == 2
    assert message in capsys.readouterr().err
    assert path.read_bytes() == content


def test_a_study_in_a_store_cannot_nest_without_end(stores: Stores, tmp_path: Path) -> None:
    path = tmp_path / "study.db"
    shutil.copy(stores.folder / "finished.db", path)
    execute(path, "UPDATE meta SET value = ? WHERE name = 'study'", (NESTED,))
    with pytest.raises(qtab.StoreError, match="its study is not JSON"):
        qtab.load_sweep(path)

"""A store that is given more seeds trains the new ones only, and has the table of a sweep that had them all."""

import contextlib
import shutil
import sqlite3
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.cli import main
from qtab.sweeps import store as stores
from qtab.sweeps import store_format
from qtab.sweeps.store import Store
from qtab.sweeps.study import plan_study
from support.sweeps import CAR, GRID, assert_equal

SHORT: dict[str, Any] = {"episodes": 20, "block": 5}
SAVED = Path(__file__).parents[2] / "results" / "files" / "saved"


def test_only_the_new_seeds_are_trained(tmp_path, small_chunks):
    path = tmp_path / "study.db"
    before = qtab.sweep(CAR, GRID, 2, store=path, **SHORT)
    seen: list[qtab.SweepProgress] = []
    after = qtab.sweep(CAR, GRID, 5, store=path, callback=seen.append, **SHORT)
    assert (seen[0].runs - seen[0].new, seen[-1].new) == (12, 18)
    assert after.seconds > before.seconds
    assert_equal(after, qtab.sweep(CAR, GRID, 5, **SHORT))
    assert qtab.load_sweep(path).columns["steps"].tolist() == after.columns["steps"].tolist()
    assert qtab.sweep(CAR, GRID, 5, store=path, **SHORT).seconds == after.seconds


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
@given(
    old=st.lists(st.integers(0, 9), min_size=1, max_size=4, unique=True),
    more=st.permutations(range(10)),
    stop=st.integers(0, 12),
)
def test_seeds_may_be_added_anywhere_and_to_an_unfinished_store(tmp_path_factory, old, more, stop):
    path = tmp_path_factory.mktemp("stores") / "study.db"
    new = [*more[:5], *(seed for seed in old if seed not in more[:5])]

    def interrupt(progress):
        if progress.runs >= stop:
            raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch, contextlib.suppress(KeyboardInterrupt):
        patch.setattr("qtab.sweeps.worker.MAX_CHUNK_RUNS", 3)
        qtab.sweep(CAR, GRID, old, store=path, callback=interrupt, **SHORT)
    assert_equal(qtab.sweep(CAR, GRID, new, store=path, **SHORT), qtab.sweep(CAR, GRID, new, **SHORT))


def test_a_store_of_an_earlier_version_is_given_more_seeds(tmp_path):
    path = tmp_path / "study.db"
    shutil.copy(SAVED / "version_2.db", path)
    grid: dict[str, Any] = {"learning_rate": [0.1, 0.2]}
    table = qtab.sweep("FrozenLake-v1", grid, seeds=5, episodes=20, store=path)
    assert len(table) == 10
    assert_equal(table, qtab.sweep("FrozenLake-v1", grid, seeds=5, episodes=20))


def test_fewer_seeds_are_refused_and_other_ones_too(tmp_path):
    path = tmp_path / "study.db"
    qtab.sweep(CAR, GRID, 3, store=path, **SHORT)
    with pytest.raises(
        qtab.StoreError, match="has runs of 3 seeds, of which this sweep has only 2; give this sweep all of them"
    ):
        qtab.sweep(CAR, GRID, 2, store=path, **SHORT)
    with pytest.raises(qtab.StoreError, match="belongs to another sweep"):
        qtab.sweep(CAR, GRID, [0, 1, 7, 8], store=path, **SHORT)
    with pytest.raises(qtab.StoreError, match="belongs to another sweep"):
        qtab.sweep(CAR, {"learning_rate": [0.1]}, 4, store=path, **SHORT)
    assert len(qtab.load_sweep(path)) == 18


def test_a_process_that_uses_the_old_seeds_stops_instead_of_storing_runs_under_other_numbers(tmp_path, small_chunks):
    path = tmp_path / "study.db"
    seen: list[int] = []

    def add_seeds(progress):
        seen.append(progress.runs)
        if len(seen) == 2:
            Store(path, plan_study(CAR, GRID, 4, 5, {"episodes": 20}).stored).close()

    with pytest.raises(
        qtab.StoreError, match="was given more seeds by another process; give this sweep the same seeds"
    ):
        qtab.sweep(CAR, GRID, 2, store=path, callback=add_seeds, **SHORT)
    assert len(qtab.load_sweep(path)) == seen[-1] > 0
    assert_equal(qtab.sweep(CAR, GRID, 4, store=path, **SHORT), qtab.sweep(CAR, GRID, 4, **SHORT))


def test_two_processes_may_add_the_same_seeds(tmp_path):
    path = tmp_path / "study.db"
    qtab.sweep(CAR, GRID, 1, store=path, **SHORT)
    stored = plan_study(CAR, GRID, 2, 5, {"episodes": 20}).stored
    with contextlib.closing(Store(path, stored)), contextlib.closing(Store(path, stored)) as second:
        assert second.finished() == 6
        assert second.claim(lambda start: 100) == range(1, 2)


def test_a_process_that_finds_the_same_seeds_added_meanwhile_leaves_the_claims_of_the_other(tmp_path, monkeypatch):
    path = tmp_path / "study.db"
    qtab.sweep(CAR, GRID, 1, store=path, **SHORT)
    stored = plan_study(CAR, GRID, 2, 5, {"episodes": 20}).stored
    check = store_format.check_study
    others: list[Any] = []

    def add_meanwhile(*arguments):
        if not others:
            others.append(None)  # this function is called by the other process, too
            others[0] = Store(path, stored)
            assert others[0].claim(lambda start: 2) == range(1, 2)
        check(*arguments)

    monkeypatch.setattr(stores, "check_study", add_meanwhile)
    with contextlib.closing(Store(path, stored)) as late, contextlib.closing(others[0]) as early:
        assert late.claim(lambda start: 2) == range(3, 4)
        assert early.claim(lambda start: 2) == range(5, 6)


def test_the_command_line_adds_seeds(tmp_path, capsys):
    study = tmp_path / "s.toml"
    for seeds in (2, 3):
        study.write_text(f'env = "{CAR}"\nseeds = {seeds}\n[grid]\nepsilon = [0.3, 0.5]\n[config]\nepisodes = 20\n')
        assert main(["sweep", str(study)]) == 0
    assert "6 runs of 2 settings" in capsys.readouterr().out


def test_damage_is_found_before_seeds_are_added(tmp_path):
    path = tmp_path / "study.db"
    qtab.sweep(CAR, GRID, 1, store=path, **SHORT)
    with contextlib.closing(sqlite3.connect(path)) as other:
        other.execute("UPDATE runs SET steps = steps + 1 WHERE run = 3")
        other.commit()
    with pytest.raises(qtab.StoreError, match="is damaged, or not a sweep store"):
        qtab.sweep(CAR, GRID, 2, store=path, **SHORT)

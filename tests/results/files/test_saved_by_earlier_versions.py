"""Runs and stores saved before the package was rearranged still load, and train to the same bytes.

The files in ``saved/`` were written by ``run.save`` and ``qtab.sweep(..., store=)`` of an earlier build of
0.1.0. Do not regenerate them.
"""

import json
import shutil
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.config.config import replace_checked
from qtab.sweeps.run_records import combined, study_digest, to_text
from qtab.sweeps.study import StoredStudy, study_from_json

SAVED = Path(__file__).with_name("saved")
RUNS = sorted(path.stem for path in SAVED.glob("*.npz"))
TOY_TEXT = ("blackjack", "double", "dyna", "frozen_lake", "softmax")
"""Environments whose numbers are the same on every machine: their steps compute no sine or cosine."""

GRID: dict[str, list[Any]] = {"learning_rate": [0.1, 0.2]}


def forget_runs_from(store: Path, start: int) -> None:
    """Removes the runs from an index on, as if the sweep had been interrupted before them."""
    with closing(sqlite3.connect(store)) as connection, connection:
        meta = dict(connection.execute("SELECT name, value FROM meta"))
        connection.execute("DELETE FROM runs WHERE run >= ?", (start,))
        connection.execute("DELETE FROM chunks WHERE start >= ?", (start,))
        digests = [int(digest, 16) for (digest,) in connection.execute("SELECT digest FROM chunks")]
        left = to_text(combined(study_digest(meta), digests))
        connection.execute("UPDATE meta SET value = ? WHERE name = 'digest'", (left,))


@pytest.mark.parametrize("name", RUNS)
def test_a_run_loads_and_saving_it_again_changes_nothing(name: str, tmp_path: Path) -> None:
    run = qtab.load(SAVED / f"{name}.npz")
    run.save(tmp_path / "again.npz")
    with np.load(SAVED / f"{name}.npz") as before, np.load(tmp_path / "again.npz") as after:
        assert json.loads(str(after["header"])) == {**json.loads(str(before["header"])), "digest": "sha256"}
        for array in set(before.files) - {"header"}:
            assert after[array].tobytes() == before[array].tobytes(), array


@pytest.mark.parametrize("name", TOY_TEXT)
def test_its_config_trains_to_the_same_bytes(name: str) -> None:
    run = qtab.load(SAVED / f"{name}.npz")
    again = qtab.train(config=run.config)
    assert again.config.env == run.config.env
    assert again.tables.tobytes() == run.tables.tobytes()
    assert again.episode_returns.tobytes() == run.episode_returns.tobytes()


@pytest.mark.parametrize("name", TOY_TEXT)
def test_it_is_verified_against_gymnasium(name: str) -> None:
    assert qtab.verify(qtab.load(SAVED / f"{name}.npz")).equal


def test_a_store_loads() -> None:
    table = qtab.load_sweep(SAVED / "version_2.db")
    assert len(table) == 6
    assert table.settings[1] == {"learning_rate": 0.2}


@pytest.mark.parametrize("runs", [0, 2, 6])
def test_a_store_resumes_and_holds_the_same_rows(runs: int, tmp_path: Path) -> None:
    """``runs`` are finished."""
    store = tmp_path / "study.db"
    shutil.copy(SAVED / "version_2.db", store)
    forget_runs_from(store, runs)
    table = qtab.sweep("FrozenLake-v1", GRID, seeds=3, episodes=20, store=store)
    expected = qtab.load_sweep(SAVED / "version_2.db")
    assert table.columns["steps"].tolist() == expected.columns["steps"].tolist()
    assert table.columns["final_return"].tolist() == expected.columns["final_return"].tolist()


@pytest.mark.parametrize(
    ("algorithm", "ignored"),
    [
        ("gradient_bandit", {"discount": 0.9, "on_truncation": "bootstrap"}),
        ("reinforce", {"on_truncation": "bootstrap"}),
        ("reinforce_with_baseline", {"on_truncation": "bootstrap"}),
    ],
)
def test_settings_that_earlier_versions_ignored_become_those_in_effect(
    algorithm: Any, ignored: dict[str, Any], tmp_path: Path
) -> None:
    run = qtab.train("CliffWalking-v1", algorithm=algorithm, episodes=6, max_episode_steps=9, seed=1)
    stopped = qtab.train(config=run.config, callback=lambda progress: progress.episodes < 3, callback_every=1)
    for name, one in (("run", run), ("stopped", stopped)):
        replace(one, config=replace_checked(one.config, **ignored)).save(tmp_path / f"{name}.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.config == run.config
    assert qtab.verify(loaded).equal
    assert qtab.train(config=loaded.config).tables.tobytes() == run.tables.tobytes()
    assert qtab.train(resume=tmp_path / "stopped.npz").tables.tobytes() == run.tables.tobytes()


def test_a_store_with_such_settings_is_that_of_the_same_sweep() -> None:
    table = qtab.sweep("CliffWalking-v1", {"algorithm": ["reinforce", "q_learning"]}, seeds=1, episodes=3)
    now = StoredStudy([dict(config) for config in table.configs], list(table.settings), (0,), 1)
    before = json.loads(now.text)
    assert [config["on_truncation"] for config in before["configs"]] == ["terminate", "bootstrap"]
    before["configs"][0]["on_truncation"] = "bootstrap"
    assert study_from_json(json.dumps(before)).text == now.text


def test_a_batch_of_which_an_earlier_file_does_not_tell_the_layout_is_refused() -> None:
    run = qtab.load(SAVED / "blackjack.npz")
    hands = np.array([(12, 2, 0), (20, 10, 0), (18, 1, 1)])
    assert run.predict(tuple(hands[:2].T))[0].tolist() == run.predict(hands[:2])[0].tolist()
    with pytest.raises(
        ValueError, match=r"^observations must be an array of shape \(3, 3\) for a run from a file of an"
    ):
        run.predict(tuple(hands.T))

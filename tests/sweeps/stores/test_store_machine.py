"""A store through any sequence of interrupted sweeps, loads, damage and repair: the right results, or StoreError."""

import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, precondition, rule

import qtab
from qtab.sweeps import worker
from support.files.damage import DAMAGE, STATEMENTS, Damage, execute
from support.sweeps import assert_equal

LAKE = "FrozenLake-v1"
GRID: dict[str, Any] = {"learning_rate": [0.1, 0.2], "algorithm": ["sarsa", "q_learning"]}
SMALL: dict[str, Any] = {"seeds": 3, "episodes": 20, "block": 5}


@cache
def undisturbed() -> qtab.Sweep:
    return qtab.sweep(LAKE, GRID, **SMALL)


class StoreMachine(RuleBasedStateMachine):
    """One store, and whether anything but the package has written to it."""

    def __init__(self) -> None:
        super().__init__()
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name) / "study.db"
        self.is_damaged = False
        self.patch = pytest.MonkeyPatch()
        self.patch.setattr(worker, "MAX_CHUNK_RUNS", 4)

    def teardown(self) -> None:
        self.patch.undo()
        self.folder.cleanup()

    def sweep(self, callback: Any = None) -> qtab.Sweep | None:
        try:
            return qtab.sweep(LAKE, GRID, store=self.path, callback=callback, **SMALL)
        except qtab.StoreError:
            assert self.is_damaged
        except KeyboardInterrupt:
            assert callback is not None
        return None

    @rule(runs=st.integers(1, 12))
    def sweep_until_interrupted(self, runs: int) -> None:
        def interrupt(progress: qtab.SweepProgress) -> None:
            if progress.runs >= runs:
                raise KeyboardInterrupt

        self.sweep(interrupt)

    @rule()
    def sweep_to_the_end(self) -> None:
        table = self.sweep()
        assert table is not None or self.is_damaged
        if table is not None:
            assert_equal(table, undisturbed())

    @precondition(lambda self: self.path.exists())
    @rule()
    def load(self) -> None:
        message, loaded = "", None
        try:
            loaded = qtab.load_sweep(self.path)
        except qtab.StoreError as error:
            message = str(error)
        if loaded is None:
            assert self.is_damaged or "is empty" in message
            return
        whole = undisturbed()
        places = {(int(s), int(n)): i for i, (s, n) in enumerate(zip(*whole_key(whole), strict=True))}
        for row, key in enumerate(zip(*whole_key(loaded), strict=True)):
            same = places[int(key[0]), int(key[1])]
            for name in ("final_return", "steps", "best_return"):
                assert loaded.columns[name][row] == whole.columns[name][same]

    @precondition(lambda self: self.path.exists() and self.path.stat().st_size > 0)
    @rule(damage=DAMAGE)
    def damage(self, damage: Damage) -> None:
        damage(self.path)
        self.is_damaged = True

    @rule()
    def begin_anew(self) -> None:
        for path in self.path.parent.iterdir():
            path.unlink()
        self.is_damaged = False


def whole_key(table: qtab.Sweep) -> tuple[Any, Any]:
    return table.columns["setting"].tolist(), table.columns["seed"].tolist()


TestStore: Any = StoreMachine.TestCase
TestStore.settings = settings(max_examples=max(settings().max_examples // 8, 1), stateful_step_count=8, deadline=None)
TestStore.pytestmark = [pytest.mark.slow]


@pytest.mark.parametrize("table", ["meta", "runs"])
def test_damage_to_a_store_with_an_endless_view_ends(tmp_path: Path, table: str) -> None:
    path = tmp_path / "study.db"
    qtab.sweep(LAKE, {"learning_rate": [0.1]}, store=path, seeds=1, episodes=5)
    (endless,) = [statement for statement in STATEMENTS if f"CREATE VIEW {table}" in statement]
    execute(path, endless)
    execute(path, f"SELECT count(*) FROM {table}")  # noqa: S608 - names above
    with pytest.raises(qtab.StoreError):
        qtab.load_sweep(path)

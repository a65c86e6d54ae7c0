"""Damage to the store of a sweep: at the level of bytes, of SQL and of JSON."""

import contextlib
import json
import sqlite3
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from qtab.sweeps.run_records import SUMMARY_COLUMNS

Damage = Callable[[Path], None]

VALUES = st.one_of(
    st.none(),
    st.integers(-(2**63), 2**63 - 1),
    st.integers(-2, 20),
    st.floats(),
    st.text(max_size=8),
    st.binary(max_size=24),
)
COLUMNS = {
    "runs": ["run", "seed", *SUMMARY_COLUMNS, "curve", "error"],
    "chunks": ["start", "stop", "seconds", "digest"],
    "meta": ["name", "value"],
}
STATEMENTS = [
    "DELETE FROM runs WHERE run < 3",
    "DELETE FROM chunks WHERE start = 0",
    "DELETE FROM chunks",
    "DELETE FROM meta WHERE name = 'digest'",
    "DELETE FROM runs WHERE run < (SELECT min(stop) FROM chunks); DELETE FROM chunks WHERE start = 0",
    "INSERT INTO runs SELECT run + 100, seed, episodes, steps, mean_return, final_return, best_return, "
    "terminated_rate, curve, error FROM runs",
    "UPDATE runs SET error = 'RuntimeError: no' WHERE run = 1",
    "UPDATE runs SET mean_return = -mean_return, steps = steps + 1",
    "UPDATE chunks SET digest = NULL",
    "CREATE VIEW more AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i FROM n) SELECT i FROM n",
    "DROP TABLE runs; CREATE VIEW runs AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i FROM n) SELECT i FROM n",
    "DROP TABLE meta; CREATE VIEW meta AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i FROM n) "
    "SELECT i AS name, i AS value FROM n",
    "CREATE TRIGGER more AFTER INSERT ON chunks BEGIN UPDATE runs SET steps = 1; END",
    "CREATE INDEX more ON runs (seed)",
    "ALTER TABLE runs ADD COLUMN more",
    "DROP TABLE chunks",
    "DROP TABLE runs",
    "UPDATE meta SET value = '1' WHERE name = 'version'",
]
HARMLESS = ["PRAGMA user_version = 7", "PRAGMA journal_mode = DELETE", "VACUUM"]
"""Statements that change the file, but not what it holds."""
NESTED = "[" * 5000 + "]" * 5000


@contextlib.contextmanager
def connected(path: Path) -> Iterator[sqlite3.Connection]:
    """A connection for a store that may be damaged already: errors end the block, and so do endless views."""
    with (
        contextlib.suppress(sqlite3.Error, OverflowError, RecursionError, ValueError),
        contextlib.closing(sqlite3.connect(path, isolation_level=None)) as connection,
    ):
        connection.set_progress_handler(lambda: 1, 1_000_000)
        yield connection


def execute(path: Path, script: str, values: tuple[Any, ...] = ()) -> None:
    """Executes statements, unless the tables refuse a value."""
    with connected(path) as connection:
        for statement in [script] if "TRIGGER" in script else script.split("; "):
            connection.execute(statement, values)


@st.composite
def byte_damage(draw: st.DrawFn) -> Damage:
    """Changes some bytes, or cuts the file, or doubles a part of it."""
    kind = draw(st.sampled_from(["xor", "xor", "xor", "cut", "zero", "copy"]))
    where = draw(st.lists(st.floats(0, 1, exclude_max=True), min_size=1, max_size=4))
    value, length = draw(st.integers(1, 255)), draw(st.integers(1, 600))

    def damage(path: Path) -> None:
        content = bytearray(path.read_bytes())
        for part in where:
            at = int(part * len(content))
            if kind == "xor":
                content[at : at + 1] = bytes(byte ^ value for byte in content[at : at + 1])
            elif kind == "cut":
                del content[at:]
            elif kind == "zero":
                content[at : at + length] = bytes(len(content[at : at + length]))
            else:
                content[at : at + length] = content[:length]
        path.write_bytes(content)

    return damage


@st.composite
def sql_damage(draw: st.DrawFn) -> Damage:
    """Changes a value of the tables, or the tables themselves."""
    if draw(st.booleans()):
        statement = draw(st.sampled_from(STATEMENTS + HARMLESS))
        return lambda path: execute(path, statement)
    table = draw(st.sampled_from(sorted(COLUMNS)))
    column, value, row = draw(st.sampled_from(COLUMNS[table])), draw(VALUES), draw(st.integers(1, 10))
    condition = "" if draw(st.booleans()) else f" WHERE rowid = {row}"
    return lambda path: execute(path, f"UPDATE {table} SET {column} = ?{condition}", (value,))  # noqa: S608 - names above


@st.composite
def json_damage(draw: st.DrawFn) -> Damage:
    """Changes a value of the study's JSON text."""
    name = draw(st.sampled_from(["configs", "settings", "seeds", "block", "episodes", "env", "learning_rate", "all"]))
    value = draw(st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(), st.just([]), st.just({})))
    raw = draw(st.sampled_from([None, None, None, NESTED, "", "3", "[]", "{}", "9" * 5000, "\ud7ff"]))

    def change(item: Any) -> Any:
        if isinstance(item, dict):
            return {key: value if key == name else change(inner) for key, inner in item.items()}
        return [change(inner) for inner in item] if isinstance(item, list) else item

    def damage(path: Path) -> None:
        with connected(path) as connection:
            (text,) = connection.execute("SELECT value FROM meta WHERE name = 'study'").fetchone() or ("{}",)
            changed = json.dumps(change(json.loads(text)) if name != "all" else value) if raw is None else raw
            connection.execute("UPDATE meta SET value = ? WHERE name = 'study'", (changed,))

    return damage


DAMAGE = st.one_of(byte_damage(), sql_damage(), json_damage())

"""A file never chooses a module to import: its environment must be registered, or the user passes it."""

import contextlib
import pickle
import sqlite3
import sys
from typing import Any

import gymnasium as gym
import pytest
from matplotlib.figure import Figure

import qtab
from qtab import plots
from qtab.envs.registry import StoredId, stored_id
from qtab.rendering.sweep_report import write_report
from qtab.sweeps.run_records import study_digest, to_text
from support.environments import Walk
from support.files.run_files import members_of, with_header, with_right_digest, write_members

MODULE = "imported_by_a_file"


@pytest.fixture
def named(tmp_path, monkeypatch):
    """Returns a function that saves a run whose file names ``MODULE`` as the package of its environment."""
    (tmp_path / f"{MODULE}.py").write_text("raise SystemExit('imported')")
    monkeypatch.syspath_prepend(tmp_path)

    def save(env: str) -> Any:
        run = qtab.train("FrozenLake-v1", seed=0, episodes=3)
        run.save(tmp_path / "run.npz")
        members = members_of(tmp_path / "run.npz")
        changed = with_header(members, lambda header: header["config"].update(env=f"{MODULE}:{env}", preset=None))
        write_members(tmp_path / "run.npz", with_right_digest(changed))
        return qtab.load(tmp_path / "run.npz")

    return save


USES: dict[str, Any] = {
    "verify": qtab.verify,
    "evaluate": qtab.evaluate,
    "train": lambda run: qtab.train(config=run.config),
    "replaced": lambda run: qtab.train(config=run.config.replace(episodes=2)),
    "train_many": lambda run: qtab.train_many(config=run.config, seeds=2),
    "sweep": lambda run: qtab.sweep(run.config.env, {"learning_rate": [0.1]}, seeds=1, episodes=2),
    "optimum": qtab.optimum,
    "its id": lambda run: qtab.optimum(run.config.env),
    "pickled": lambda run: qtab.evaluate(pickle.loads(pickle.dumps(run))),  # noqa: S301
    "explain": qtab.explain,
    "trajectory": lambda run: plots.trajectory(run, Figure().subplots(), episodes=1),
}
LOOKS: dict[str, Any] = {
    "values": lambda run: plots.values(run, Figure().subplots()),
    "policy": lambda run: plots.policy(run, Figure().subplots()),
    "diagnose": lambda run: qtab.diagnose(run, seeds=0),
}
"""They need the environment only for what they can do without."""


@pytest.mark.parametrize("use", [*USES.values(), *LOOKS.values()], ids=[*USES, *LOOKS])
def test_nothing_is_imported_for_a_registered_environment(named, use):
    run = named("FrozenLake-v1")
    assert run.config.env == f"{MODULE}:FrozenLake-v1"
    use(run)
    assert MODULE not in sys.modules


@pytest.mark.parametrize("use", USES.values(), ids=USES)
def test_an_environment_that_is_not_registered_is_refused_with_what_helps(named, use):
    run = named("Unknown-v0")
    with pytest.raises((gym.error.UnregisteredEnv, ValueError), match=r"is not (registered|a registered id)") as caught:
        use(run)
    if not isinstance(caught.value, ValueError):
        assert f"import {MODULE} first, or pass env=" in str(caught.value)
    assert MODULE not in sys.modules


@pytest.fixture
def named_store(named, tmp_path):
    """Returns a function that makes a store which names ``MODULE`` as the package of its environment."""

    def make(env: str) -> Any:
        path = tmp_path / "study.db"
        qtab.sweep("FrozenLake-v1", {"learning_rate": [0.1, 0.2]}, seeds=2, episodes=2, store=path)
        with contextlib.closing(sqlite3.connect(path)) as connection:
            meta = dict(connection.execute("SELECT name, value FROM meta"))
            changed = meta | {"study": meta["study"].replace('"FrozenLake-v1"', f'"{MODULE}:{env}"')}
            changed["digest"] = to_text(int(meta["digest"], 16) ^ study_digest(meta) ^ study_digest(changed))
            connection.executemany(
                "UPDATE meta SET value = ? WHERE name = ?", [*zip(changed.values(), changed, strict=True)]
            )
            connection.commit()
        return qtab.load_sweep(path)

    return make


def test_the_store_of_a_sweep_chooses_no_module_either(named_store, tmp_path):
    sweep = named_store("FrozenLake-v1")
    assert sweep.env == sweep.configs[1]["env"] == f"{MODULE}:FrozenLake-v1"
    assert qtab.train(sweep.env, episodes=1).config.env == sweep.env
    assert len(sweep.confirm(1).confirmed) == 1
    assert write_report(sweep, tmp_path / "report")
    assert MODULE not in sys.modules


def test_a_store_of_an_environment_that_is_not_registered_is_refused_with_what_helps(named_store):
    sweep = named_store("Unknown-v0")
    for env in (sweep.env, sweep.configs[1]["env"]):
        with pytest.raises(gym.error.UnregisteredEnv, match=f"import {MODULE} first, or pass env="):
            qtab.train(env)
    with pytest.raises(ValueError, match="must be registered, or given as env="):
        sweep.confirm(1)
    assert MODULE not in sys.modules


def test_it_loads_so_that_it_can_be_looked_at_and_the_user_can_pass_the_environment(named):
    run = named("Unknown-v0")
    assert len(run.episode_returns) == 3
    assert run.q_table.shape == (16, 4)
    assert qtab.evaluate(run, 3, seed=0, env=gym.make("FrozenLake-v1")).seed == 0


def test_a_user_can_name_a_package_as_before():
    with pytest.raises(ModuleNotFoundError, match="no_such_package"):
        qtab.train("no_such_package:FrozenLake-v1")
    assert qtab.train("qtab:qtab/FrozenLake-v1", episodes=1).config.env == "qtab:qtab/FrozenLake-v1"


def test_an_id_from_a_file_equals_the_text_and_stays_one_when_pickled():
    env = stored_id("package:Name-v0")
    assert isinstance(env, StoredId)
    assert isinstance(pickle.loads(pickle.dumps(env)), StoredId)  # noqa: S301
    assert env == "package:Name-v0"
    assert type(stored_id("Name-v0")) is str
    assert stored_id(3) == 3


@pytest.mark.parametrize("use", [qtab.evaluate, qtab.verify])
@pytest.mark.parametrize("reload", [False, True])
def test_a_run_of_ones_own_environment_asks_for_it(tmp_path, use, reload):
    run = qtab.train(Walk(start=5), scale=(3, 0.7), seed=0, episodes=2, max_episode_steps=20)
    if reload:
        run.save(tmp_path / "run.npz")
        run = qtab.load(tmp_path / "run.npz")
    with pytest.raises(gym.error.UnregisteredEnv, match=r"environment 'Walk' is not registered .*: pass env="):
        use(run)
    use(run, env=Walk(start=5))


class MountainCar(Walk):
    """An environment whose name is that of a registered one without its version."""


def test_the_name_of_a_class_is_not_taken_for_an_id():
    run = qtab.train(MountainCar(start=5), scale=(3, 0.7), seed=0, episodes=2, max_episode_steps=20)
    assert run.config.env == "MountainCar"
    for use in (qtab.evaluate, lambda run: qtab.resume(run, 3), lambda run: qtab.train(resume=run, seed=0, episodes=3)):
        with pytest.raises(
            gym.error.UnregisteredEnv, match=r"environment 'MountainCar' is not registered .*: pass env="
        ):
            use(run)

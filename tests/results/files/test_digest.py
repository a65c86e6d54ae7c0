"""A digest ties the header and the arrays of a run file together, and what they hold has to make sense."""

import hashlib
import json
import logging
from typing import Any

import numpy as np
import pytest

import qtab
from support.files.run_files import Members, members_of, with_header, with_right_digest, without_digest, write_members
from support.processes.command import qtab_here

REFUSED = "is not a run file that this version of qtab can read: "


@pytest.fixture(scope="module")
def run() -> qtab.Run:
    return qtab.train("FrozenLake-v1", seed=0, episodes=6, algorithm="sarsa", initial_q=0.5)


@pytest.fixture
def members(run, tmp_path) -> Members:
    run.save(tmp_path / "run.npz")
    return members_of(tmp_path / "run.npz")


def config(**changes: Any) -> Any:
    return lambda header: header["config"].update(changes)


def test_the_digest_is_that_of_the_header_and_the_arrays(members):
    arrays = {name: array for name, array in members.items() if name not in ("header", "digest")}
    described = {name: [array.dtype.str, list(array.shape)] for name, array in arrays.items()}
    text = json.dumps(
        {"header": json.loads(str(members["header"])), "arrays": described}, sort_keys=True, separators=(",", ":")
    )
    expected = hashlib.sha256(text.encode() + b"".join(arrays[name].tobytes() for name in sorted(arrays)))
    assert str(members["digest"]) == expected.hexdigest()


CHANGES = {
    "another algorithm": lambda members: with_header(members, config(algorithm="q_learning")),
    "another discount": lambda members: with_header(members, config(discount=0.5)),
    "another seed": lambda members: with_header(members, config(seed=1)),
    "other versions": lambda members: with_header(members, lambda header: header["versions"].update(numpy="9")),
    "another value": lambda members: members | {"tables": members["tables"] + 1e-12},
    "returns and lengths swapped": lambda members: (
        members
        | {"episode_lengths": members["episode_returns"].astype(int) + 1, "episode_returns": members["episode_returns"]}
    ),
    "an array more": lambda members: members | {"edges": np.zeros(3)},
    "the digest cut": lambda members: members | {"digest": np.array(str(members["digest"])[:-1])},
    "the digest of zeros": lambda members: members | {"digest": np.zeros(32, np.uint8)},
    "another kind of digest": lambda members: with_header(members, lambda header: header.update(digest="md5")),
    "the digest left out": lambda members: {name: array for name, array in members.items() if name != "digest"},
    "no mention of the digest": lambda members: with_header(members, lambda header: header.pop("digest")),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_a_changed_file_is_refused(members, tmp_path, change):
    write_members(tmp_path / "changed.npz", change(members))
    with pytest.raises(ValueError, match=f"{REFUSED}its digest"):
        qtab.load(tmp_path / "changed.npz")


def test_a_file_without_a_digest_loads_and_is_said_to_be_unchecked(run, members, tmp_path, caplog):
    path = tmp_path / "old.npz"
    write_members(path, without_digest(members))
    with caplog.at_level(logging.WARNING, logger="qtab"):
        old = qtab.load(path)
    assert "has no digest" in caplog.text
    assert str(path) in caplog.text
    assert old.unchecked
    assert "from a file without a digest" in repr(old)
    assert old.tables.tobytes() == run.tables.tobytes()
    old.save(path)
    caplog.clear()
    assert not qtab.load(path).unchecked
    assert not caplog.text


IMPOSSIBLE: dict[str, tuple[str, Any, str]] = {
    "nan in a table": ("tables", np.nan, "tables must be finite"),
    "infinity in a table": ("tables", np.inf, "tables must be finite"),
    "an action that no initial_q excludes": ("tables", -np.inf, "tables must be finite"),
    "a return that is nan": ("episode_returns", np.nan, "episode_returns must be finite, got nan"),
    "an infinite return": ("episode_returns", np.inf, "episode_returns must be finite, got inf"),
    "an episode without steps": ("episode_lengths", 0, "between 1 and max_episode_steps = 100, got 0"),
    "an episode of negative length": ("episode_lengths", -5, "between 1 and max_episode_steps = 100, got -5"),
    "an episode beyond the limit": ("episode_lengths", 101, "between 1 and max_episode_steps = 100, got 101"),
}
HEADERS: dict[str, tuple[Any, str]] = {
    "negative seconds": (lambda header: header.update(seconds=-1.0), "seconds must be finite and not negative"),
    "seconds that are text": (lambda header: header.update(seconds="1.0"), "seconds must be a number, got '1.0'"),
    "seconds that are true": (lambda header: header.update(seconds=True), "seconds must be a number, got True"),
    "half an action": (lambda header: header.update(actions=4.5), "actions must be an integer, got 4.5"),
    "a first action as text": (lambda header: header.update(first_action="0"), "first_action must be an integer"),
    "versions that are numbers": (lambda header: header.update(versions={"qtab": 1}), "versions"),
    "completed as a number": (lambda header: header.update(completed=1), "it must have 6 episodes if it is complete"),
    "not completed": (lambda header: header.update(completed=False), "it must have 6 episodes if it is complete"),
}


@pytest.mark.parametrize("finish", [without_digest, with_right_digest])
@pytest.mark.parametrize(("name", "value", "message"), IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_an_impossible_number_is_refused_with_or_without_a_digest(members, tmp_path, name, value, message, finish):
    members[name] = members[name].copy()
    members[name].flat[-1] = value
    write_members(tmp_path / "changed.npz", finish(members))
    with pytest.raises(ValueError, match=f"{REFUSED}.*{message}"):
        qtab.load(tmp_path / "changed.npz")


@pytest.mark.parametrize("finish", [without_digest, with_right_digest])
@pytest.mark.parametrize(("change", "message"), HEADERS.values(), ids=HEADERS)
def test_an_impossible_header_is_refused_with_or_without_a_digest(members, tmp_path, change, message, finish):
    write_members(tmp_path / "changed.npz", finish(with_header(members, change)))
    with pytest.raises(ValueError, match=f"{REFUSED}.*{message}"):
        qtab.load(tmp_path / "changed.npz")


def test_a_name_that_appears_twice_in_the_header_is_refused(members, tmp_path):
    text = str(members["header"])
    write_members(tmp_path / "run.npz", members | {"header": np.array(text.replace("{", '{"seconds": 1.0, ', 1))})
    with pytest.raises(ValueError, match=f"{REFUSED}.*two values"):
        qtab.load(tmp_path / "run.npz")


def test_missing_actions_stay_minus_infinity_and_only_they(tmp_path):
    initial_q = np.zeros((16, 4))
    initial_q[3, 1] = -np.inf
    for algorithm in ("q_learning", "double_q_learning"):
        run = qtab.train("FrozenLake-v1", seed=0, episodes=3, algorithm=algorithm, initial_q=initial_q)
        run.save(tmp_path / "run.npz")
        assert qtab.load(tmp_path / "run.npz").tables.tobytes() == run.tables.tobytes()
        changed = members_of(tmp_path / "run.npz")
        changed["tables"][..., 3, 1] = 0.0
        write_members(tmp_path / "run.npz", with_right_digest(changed))
        with pytest.raises(
            ValueError, match=r"tables must be finite, and -inf for the actions that initial_q excludes"
        ):
            qtab.load(tmp_path / "run.npz")


DIVERGES: dict[str, Any] = {
    "algorithm": "sarsa_lambda",
    "traces": "accumulating",
    "trace_decay": 1.0,
    "discount": 1.0,
    "learning_rate": 2.0,
    "tilings": 32,
}


def test_a_run_whose_values_overflowed_is_not_saved(tmp_path):
    with pytest.raises(OverflowError) as caught:
        qtab.train("MountainCar-v0", preset="solved", seed=0, **DIVERGES)
    with pytest.raises(ValueError, match="this run cannot be saved: its tables must be finite"):
        caught.value.run.save(tmp_path / "run.npz")  # type: ignore[attr-defined]
    arguments = [f"--{name.replace('_', '-')}={value}" for name, value in DIVERGES.items()]
    failed = qtab_here("train", "MountainCar-v0", "--preset=solved", *arguments, "--save", "run.npz", cwd=tmp_path)
    assert failed.returncode == 1
    assert "this run cannot be saved" in failed.stdout
    assert "the action values overflowed" in failed.stderr.splitlines()[-1]
    assert [path.name for path in tmp_path.iterdir()] == ["toys.py"]


def test_the_reason_is_one_short_line_whatever_the_file_holds(members, tmp_path):
    write_members(tmp_path / "run.npz", with_header(without_digest(members), config(algorithm="x\n" * 10**5)))
    with pytest.raises(ValueError, match=REFUSED) as caught:
        qtab.load(tmp_path / "run.npz")
    assert len(str(caught.value)) < 600 + len(str(tmp_path))
    assert "\n" not in str(caught.value)

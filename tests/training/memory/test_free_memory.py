"""A table is refused before it is made when it does not fit into what the machine has free."""

import ctypes
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from gymnasium.spaces import Box, Discrete

import qtab
from qtab._utils import memory
from qtab.discretizers import base
from support.environments import Sampled


@pytest.fixture
def free(monkeypatch: pytest.MonkeyPatch) -> int:
    """A machine with 100 MB of free memory and any amount of memory."""
    count = 100_000_000
    for module in (memory, base):
        monkeypatch.setattr(module, "free_memory", lambda: count)
    return count


def test_a_discrete_space_of_a_billion_states_is_refused(free: int) -> None:
    env = Sampled(Discrete(10**9))
    env.action_space = Discrete(2)
    with pytest.raises(
        ValueError, match=r"^the observation space must give a table that fits into memory .*max_rows=.*, got Discrete"
    ) as e:
        qtab.train(env, episodes=1)
    assert str(e.value).endswith("needs 2e+09 values or 14.9 GiB, more than is free")


@pytest.mark.parametrize(
    ("env", "settings", "name"),
    [
        ("MountainCar-v0", {"scale": (3000, 25_000)}, "scale"),
        ("MountainCar-v0", {"discretizer": "bins", "bins": 4000}, "bins"),
        ("MountainCar-v0", {"discretizer": "tiles", "tiles": 2000}, "tiles"),
        ("MountainCar-v0", {"discretizer": "tiles", "hashed_rows": 10**7}, "hashed_rows"),
        ("MountainCar-v0", {"discretizer": lambda _: 0, "shape": 10**7}, "shape"),
        ("FrozenLake-v1", {"max_rows": 10**7}, "max_rows"),
        (Sampled(Box(0, 999, (3,), int)), {}, "the observation space"),
    ],
    ids=["cells", "bins", "tiles", "hashed rows", "function", "rows", "integers"],
)
def test_a_table_that_does_not_fit_is_refused_by_the_setting_that_decides(
    free: int, env: Any, settings: dict[str, Any], name: str
) -> None:
    with pytest.raises(ValueError, match=rf"^{name} must give a table that fits into memory.* more than is free"):
        qtab.train(env, episodes=1, **settings)


def test_what_an_algorithm_keeps_beside_a_table_that_fits_is_counted_against_what_is_free(free: int) -> None:
    settings: dict[str, Any] = {"discretizer": "bins", "bins": 1700, "episodes": 1}  # 66 MiB
    with pytest.raises(MemoryError, match=r"^1 episode with a table .* more than the 95.4 MiB of memory that are free"):
        qtab.train("MountainCar-v0", algorithm="dyna_q", **settings)


def test_verify_counts_the_tables_of_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    run = qtab.train("MountainCar-v0", discretizer="bins", bins=1300, episodes=1, max_episode_steps=2)
    monkeypatch.setattr(memory, "free_memory", lambda: run.tables.nbytes)
    with pytest.raises(MemoryError, match=r"^the tables of the reference would take"):
        qtab.verify(run)


def test_a_small_table_needs_no_look_at_what_is_free(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda: 0)
    monkeypatch.setattr(base, "free_memory", lambda: 0)
    assert qtab.train("FrozenLake-v1", episodes=1).completed


def test_a_limit_that_is_given_is_the_users_decision(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda: 0)
    memory.check_memory("this", 2**40, 2**41)
    with pytest.raises(MemoryError, match=r"^this would take 128 MiB, more than the 0 bytes of memory that are free"):
        memory.check_memory("this", 2**27)


@pytest.mark.parametrize(("limit", "expected"), [("3000\n", 2000), ("max\n", None), ("900\n", 0)])
def test_the_limit_of_a_container_counts(
    limit: str, expected: int | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    paths = tmp_path / "max", tmp_path / "current"
    for path, text in zip(paths, (limit, "1000\n"), strict=True):
        path.write_text(text)
    without = memory.free_memory()
    monkeypatch.setattr(memory, "_CONTROL_GROUPS", (tuple(map(str, paths)),))
    found = memory.free_memory()
    assert found == expected if expected is not None else found > min(without, 10_000)


@pytest.mark.parametrize(
    ("answer", "limit", "free"), [(1, 8 * 2**30, 3 * 2**30), (0, memory.DEFAULT_LIMIT, sys.maxsize)]
)
def test_windows_is_asked_for_the_memory_of_the_machine(
    monkeypatch: pytest.MonkeyPatch, answer: int, limit: int, free: int
) -> None:
    """By a stand-in for its library; where Windows does not answer, the limit is the default."""

    def global_memory_status(pointer: Any) -> int:
        status = pointer._obj
        assert status.length == ctypes.sizeof(status) == 64
        if answer:
            status.total, status.free = 16 * 2**30, 3 * 2**30
        return answer

    kernel = SimpleNamespace(GlobalMemoryStatusEx=global_memory_status)
    monkeypatch.setattr(ctypes, "windll", SimpleNamespace(kernel32=kernel), raising=False)
    monkeypatch.setattr(memory, "sys", SimpleNamespace(platform="win32", maxsize=sys.maxsize))
    monkeypatch.setattr(memory, "_CONTROL_GROUPS", ())
    monkeypatch.setattr(memory, "Path", lambda _: Path("/nowhere"))
    assert (memory.memory_limit(None), memory.free_memory()) == (limit, free)


@pytest.mark.parametrize(
    ("count", "text"),
    [(1, "1 byte"), (999, "999 bytes"), (1023, "1023 bytes"), (1536, "1.5 KiB"), (1023 * 2**10, "1023 KiB")],
)
def test_sizes_have_no_exponents(count: int, text: str) -> None:
    assert memory.readable_size(count) == text

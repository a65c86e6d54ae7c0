"""Numba compiles in these tests, although those of the benchmarks disable it in the same process."""

from collections.abc import Iterator

import gymnasium as gym
import pytest


@pytest.fixture(autouse=True)
def numba_compiles(monkeypatch: pytest.MonkeyPatch) -> None:
    numba = pytest.importorskip("numba")
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    monkeypatch.setattr(numba.config, "DISABLE_JIT", 0)


@pytest.fixture(scope="module")
def unregistered() -> Iterator[None]:
    """Removes the ids ``QtabVec/...`` from the registry after the tests of a module."""
    yield
    for name in [one for one in gym.registry if one.startswith("QtabVec/")]:
        del gym.registry[name]

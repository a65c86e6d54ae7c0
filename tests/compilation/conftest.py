"""Numba compiles in these tests, although those of the benchmarks disable it in the same process."""

import pytest


@pytest.fixture(autouse=True)
def numba_compiles(monkeypatch: pytest.MonkeyPatch) -> None:
    numba = pytest.importorskip("numba")
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    monkeypatch.setattr(numba.config, "DISABLE_JIT", 0)

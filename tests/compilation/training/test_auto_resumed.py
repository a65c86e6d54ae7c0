"""A run that was compiled by default is resumed where Numba is missing, exactly."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import qtab
from qtab.config.origin import copied
from support.lockstep.compiled_runs import LONG, Grows, stopped, trained_until, windy
from support.parity import assert_same_run
from support.processes.posix import posix_only

pytest.importorskip("numba")


@pytest.fixture(autouse=True)
def _files_of_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@posix_only
@pytest.mark.parametrize("make", [Grows, windy])
@pytest.mark.parametrize("within", [False, True])
def test_a_run_that_was_compiled_by_default_is_resumed_without_numba(
    make: Any, within: bool, tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = {**LONG, "max_episode_steps": 3_100}
    part = stopped(0.02, make, **settings) if within else trained_until(3, make, **settings)
    finished = len(part.episode_returns) + 1
    whole = trained_until(finished, make, **settings)
    assert part.config.origin is not None
    by_default = replace(part.config.origin, derived=part.config.origin.derived | {"backend"})
    part = replace(part, config=copied(part.config, by_default))
    part.save(tmp_path / "part.npz")
    monkeypatch.setitem(sys.modules, "numba", None)
    loaded = qtab.load(tmp_path / "part.npz")
    assert_same_run(trained_until(finished, make, loaded), whole)
    assert "is resumed in Python" in caplog.text
    asked = replace(loaded, config=copied(loaded.config, replace(by_default, derived=frozenset())))
    with pytest.raises(ValueError, match="Numba is not installed"):
        qtab.resume(asked, env=make())

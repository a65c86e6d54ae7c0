"""Arguments that are paths of files."""

from collections.abc import Callable
from typing import Any

import pytest

import qtab

RUN = qtab.train("FrozenLake-v1", seed=0, episodes=2)
RUNS = qtab.train_many("FrozenLake-v1", seeds=2, episodes=2)
CALLS: dict[str, Callable[[Any], Any]] = {
    "load": qtab.load,
    "load_runs": qtab.load_runs,
    "save": RUN.save,
    "save of many": RUNS.save,
    "to_json": RUN.to_json,
    "to_html": RUN.to_html,
    "animate": lambda path: qtab.animate(qtab.train("FrozenLake-v1", episodes=2, snapshots=1), path),
}


@pytest.mark.parametrize("name", CALLS)
def test_what_is_no_path_is_refused_by_name(name: str) -> None:
    for wrong in (3, b"run.npz"):
        with pytest.raises(TypeError, match=f"^path must be a path, got {wrong!r}$"):
            CALLS[name](wrong)
    with pytest.raises(ValueError, match=r"^path must be a path, got 'a\\x00b\.gif', which has a null character$"):
        CALLS[name]("a\0b.gif")
    with pytest.raises(ValueError, match=r"^path must name a file, got ''$"):
        CALLS[name]("")

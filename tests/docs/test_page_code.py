"""The Python of the pages runs, and prints what they show, which `.ci/run docs` tests.

A block of ```` ```python ```` is run. One of ```` ```py ```` is only compiled: it needs a display, a key or patience.
"""

import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

import qtab
from support.documents import pages
from support.repository import ROOT

WITH_PYTHON = [
    path for path in pages.pages() if path.parent != ROOT and [*pages.blocks(path.read_text(encoding="utf-8"))]
]
NEEDS = {
    "docs/how_to/stable_baselines3.md": "stable_baselines3",
    "docs/how_to/cluster.md": "distributed",
    "docs/walkthroughs/lunar_lander.md": "Box2D",
}
"""Libraries without which a page is skipped."""
FEWER = {
    "docs/index.md": {r"seeds=\d+": "seeds=20"},
    "docs/gallery/motion.md": {r"snapshots=\d+": "snapshots=2"},
    "docs/tutorial/why_it_fails.md": {r"seeds=\d+": "seeds=3"},
}
"""Patterns to replace in the code of a page, so that it takes seconds."""


class Recorder:
    """Stands for a tracking library: takes any call, and writes down its name and arguments."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, tuple[Any, ...], dict[str, Any]]] = []

    def __getattr__(self, name: str) -> Any:
        def call(*arguments: Any, **keywords: Any) -> "Recorder":
            self.calls.append((name, arguments, keywords))
            return self

        return call


def check_actions(namespace: dict[str, Any]) -> None:
    assert namespace["run"].action_names[1] == "{dimmer: 1, lamps: (0, 1)}"
    assert repr(namespace["run"].predict(0)[0]) == "{'dimmer': 2, 'lamps': array([1, 1], dtype=int8)}"
    assert namespace["taxi"].action_masks.shape == (500, 6)
    assert namespace["lake"].config.backend == "rust"


def check_callbacks(namespace: dict[str, Any]) -> None:
    assert len(qtab.load("best.npz").episode_returns) <= len(qtab.load("run.npz").episode_returns)
    assert namespace["run"].episode_returns[-100:].mean() >= -105
    assert Path("log.csv").read_text().count("\n") == len(namespace["run"].episode_returns) // 100 + 1
    wandb, mlflow = namespace["wandb"], namespace["mlflow"]
    assert [name for name, _, _ in wandb.calls] == ["init", *["log"] * 50, "finish"]
    assert [name for name, _, _ in mlflow.calls] == ["start_run", "log_params", *["log_metrics"] * 10, "end_run"]
    for _, (values,), keywords in wandb.calls[1:-1] + mlflow.calls[2:-1]:
        assert set(values) == {"return", "epsilon"}
        assert keywords["step"] % 100 == 0
    assert len(namespace["runs"]) % 16 == 0


def check_motion(namespace: dict[str, Any]) -> None:
    assert Path("run.html").stat().st_size < 1_000_000
    with Image.open("learning.gif") as gif:
        assert gif.n_frames == 2
    with Image.open("agent.gif") as made, Image.open(ROOT / "docs/gallery/pictures/agent.gif") as stored:
        assert (made.size, made.n_frames) == (stored.size, stored.n_frames)


CHECKS = {
    "docs/how_to/actions.md": check_actions,
    "docs/how_to/callbacks.md": check_callbacks,
    "docs/gallery/motion.md": check_motion,
}
"""What else holds after a page."""


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.chdir(tmp_path)
    # The tracking libraries are not installed: these write down their calls.
    for name in ("wandb", "mlflow"):
        monkeypatch.setitem(sys.modules, name, Recorder())
    handler = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, handler)


@pytest.mark.docs
@pytest.mark.filterwarnings("ignore:.*More than 20 figures:RuntimeWarning")
@pytest.mark.parametrize("page", WITH_PYTHON, ids=pages.page_id)
def test_the_python_of_a_page_runs(page: Path) -> None:
    name = pages.page_id(page)
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    namespace = pages.run(page, fewer=FEWER.get(name))
    CHECKS.get(name, lambda _: None)(namespace)


@pytest.mark.docs
def test_the_readmes_python_runs(tmp_path: Path) -> None:
    """With fewer seeds and snapshots."""
    page = ROOT / "README.md"
    namespace = pages.run(page, fewer={r"snapshots=\d+": "snapshots=2", r"seeds=\d+": "seeds=4"})
    assert len([*pages.blocks(page.read_text(encoding="utf-8"))]) > 3
    assert isinstance(namespace["run"], qtab.Run)
    assert (tmp_path / "learning_curve.png").stat().st_size > 0


@pytest.mark.parametrize("page", pages.pages(), ids=pages.page_id)
def test_python_that_is_only_shown_compiles(page: Path) -> None:
    for block in pages.blocks(page.read_text(encoding="utf-8"), "py"):
        compile(block.code, str(page), "exec")


def test_what_a_page_prints_is_compared() -> None:
    assert pages.matches("a\nb ... d\n", "a\nb c d\n\n")
    assert pages.matches("...\nstep 0\n", "first\n\nstep 0\n")
    assert not pages.matches("a\nb\n", "a\nc\n")
    text = "```python\nprint(1)\n```\n```text\n1\n```\n\n```python\nx = 1\n```\n\n```text\n2\n```\n"
    assert [block.printed for block in pages.blocks(text)] == ["1\n", None]

"""The script of docs/gallery/motion.md makes the pictures of its page."""

from pathlib import Path
from re import DOTALL, MULTILINE, findall, sub

import pytest
from PIL import Image

from support.repository import ROOT

PAGE = ROOT / "docs" / "gallery" / "motion.md"


@pytest.mark.slow
def test_the_code_of_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With fewer snapshots; the agent's picture is the one that is stored."""
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, object] = {}
    for block in findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), DOTALL | MULTILINE):
        exec(sub(r"snapshots=\d+", "snapshots=2", block), namespace)  # noqa: S102 - our own page
    assert (tmp_path / "run.html").stat().st_size < 1_000_000
    with Image.open("learning.gif") as gif:
        assert gif.n_frames == 2
    with Image.open("agent.gif") as made, Image.open(PAGE.parent / "agent.gif") as stored:
        assert (made.size, made.n_frames) == (stored.size, stored.n_frames)


def test_the_pictures_are_small() -> None:
    sizes = {path.name: path.stat().st_size for path in PAGE.parent.glob("*.gif")}
    assert set(sizes) == {"agent.gif", "learning.gif"}
    assert max(sizes.values()) < 400_000

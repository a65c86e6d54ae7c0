"""The pictures of docs/gallery/motion.md; `tests/docs/test_page_code.py` runs its code."""

from support.repository import ROOT


def test_the_pictures_are_small() -> None:
    sizes = {path.name: path.stat().st_size for path in (ROOT / "docs/gallery/pictures").glob("*.gif")}
    assert set(sizes) == {"agent.gif", "learning.gif"}
    assert max(sizes.values()) < 400_000

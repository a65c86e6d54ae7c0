"""The script of the gallery makes the pictures of its page."""

import importlib.util
from pathlib import Path
from typing import Any

from PIL import Image

from support.repository import ROOT

PAGE = ROOT / "docs" / "gallery" / "index.md"


def script() -> Any:
    spec = importlib.util.spec_from_file_location("gallery", ROOT / "docs" / "gallery" / "pictures.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_block_of_the_page_makes_its_picture(tmp_path: Path) -> None:
    gallery = script()
    found = gallery.blocks(PAGE)
    imports = "import qtab\n"
    gallery.draw(imports + found["pictures/lake.png"], {}, tmp_path / "lake.png")
    with Image.open(tmp_path / "lake.png") as drawn, Image.open(PAGE.parent / "pictures/lake.png") as stored:
        assert drawn.size == stored.size


def test_every_picture_of_the_gallery_has_its_code_and_is_small() -> None:
    pictures = {f"pictures/{path.name}" for path in PAGE.parent.glob("pictures/*.png")}
    assert set(script().blocks(PAGE)) == pictures
    assert max(path.stat().st_size for path in PAGE.parent.glob("pictures/*.png")) < 100_000

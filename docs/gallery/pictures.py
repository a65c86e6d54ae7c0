"""Makes the pictures of docs/gallery/index.md by running its code: the last figure of a block is the picture below it.

python docs/gallery/pictures.py               # all of them, in about a minute
python docs/gallery/pictures.py lake windy    # only some; the code is run from the top in any case
"""

import re
import sys
from pathlib import Path
from typing import Any

from PIL import Image

COLORS = 200
"""The pictures are reduced to this many colors, which keeps the files small."""
DOTS_PER_INCH = 75
BLOCK = re.compile(r"^```python\n(?P<code>.*?)^```\n\n!\[[^\]]*\]\((?P<picture>[^)]+)\)", re.DOTALL | re.MULTILINE)


def blocks(page: Path) -> dict[str, str]:
    """Returns the code of each picture of a page, by the path of the picture relative to the page."""
    return {found["picture"]: found["code"] for found in BLOCK.finditer(page.read_text(encoding="utf-8"))}


def draw(code: str, namespace: dict[str, Any], path: Path, *, dots_per_inch: int = DOTS_PER_INCH) -> None:
    """Runs a block and writes its ``ax`` or ``figure`` to a file."""
    namespace.pop("ax", None)
    namespace.pop("figure", None)
    exec(code, namespace)  # noqa: S102 - the page's own code
    figure = namespace["ax"].figure if "ax" in namespace else namespace["figure"]
    figure.savefig(path, dpi=dots_per_inch)
    Image.open(path).convert("RGB").quantize(COLORS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(
        path, optimize=True
    )


def main() -> None:
    """Draws all pictures, or those named on the command line."""
    page = Path(__file__).with_name("index.md")
    namespace: dict[str, Any] = {}
    wanted = set(sys.argv[1:])
    for picture, code in blocks(page).items():
        path = page.parent / picture
        if wanted and path.stem not in wanted:
            exec(code, namespace)  # noqa: S102 - a later block may need its runs
            continue
        draw(code, namespace, path)
        print(f"{picture}: {path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()

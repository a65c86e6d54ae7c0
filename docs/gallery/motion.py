"""Makes the pictures of docs/gallery/motion.md by running its code.

python docs/gallery/motion.py    # in about half a minute
"""

import os
import re
import tempfile
from pathlib import Path
from typing import Any

BLOCK = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)


def main() -> None:
    """Runs the blocks of the page in one namespace, and keeps the files that the page shows."""
    page = Path(__file__).resolve().with_suffix(".md")
    text = page.read_text(encoding="utf-8")
    pictures = [page.parent / name for name in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text)]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        namespace: dict[str, Any] = {}
        for block in BLOCK.findall(text):
            exec(block, namespace)  # noqa: S102 - the page's own code
        for picture in pictures:
            picture.write_bytes(Path(picture.name).read_bytes())
            print(f"{picture.name}: {picture.stat().st_size / 1000:.0f} kB")
        print(f"run.html: {Path('run.html').stat().st_size / 1000:.0f} kB")
        os.chdir(page.parent)


if __name__ == "__main__":
    main()

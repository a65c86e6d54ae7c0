"""Runs every experiment of the book at its full count: tables on standard output, pictures into docs/book."""

from pathlib import Path
from typing import Any

from PIL import Image

import qtab

COLORS = 48
"""Enough for a few lines and their bands; the files stay small."""

folder = Path(__file__).parent / "book"
folder.mkdir(exist_ok=True)
for name, experiment in qtab.book.EXPERIMENTS.items():
    result = experiment.run()
    print(result, end="\n\n", flush=True)
    figure: Any = result.plot().figure
    path = folder / f"{name}.png"
    figure.savefig(path, dpi=75)
    Image.open(path).convert("RGB").quantize(COLORS).save(path, optimize=True)

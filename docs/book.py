"""Runs experiments of the book, all where none is named: tables on standard output, pictures into docs/book."""

import sys
from pathlib import Path
from typing import Any

from PIL import Image

import qtab

COLORS = 96
"""Enough for a few lines and their bands; the files stay small."""

folder = Path(__file__).parent / "book"
folder.mkdir(exist_ok=True)
for name in sys.argv[1:] or qtab.book.EXPERIMENTS:
    experiment = qtab.book.find(name)
    result = experiment.run()
    print(result, end="\n\n", flush=True)
    figure: Any = result.plot().figure
    path = folder / f"{experiment.name}.png"
    figure.savefig(path, dpi=75)
    Image.open(path).convert("RGB").quantize(COLORS).save(path, optimize=True)

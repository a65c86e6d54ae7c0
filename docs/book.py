"""Reproduces the book's figures: prints each table and writes each picture to docs/book.

python docs/book.py            # all of them
python docs/book.py 6.3 10.4   # some of them
"""

import sys
from pathlib import Path
from typing import Any

from PIL import Image

import qtab

COLORS = 96
"""The pictures are reduced to this many colours, which keeps the files small."""

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

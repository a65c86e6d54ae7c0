"""Reproduces the book's figures: prints each table and writes each picture to docs/book/pictures.

python docs/book/pictures.py            # all of them
python docs/book/pictures.py 6.3 10.4   # some of them
"""

import sys
from pathlib import Path
from typing import Any

from PIL import Image

import qtab

DOTS_PER_INCH = 110

folder = Path(__file__).parent / "pictures"
folder.mkdir(exist_ok=True)
for name in sys.argv[1:] or qtab.book.EXPERIMENTS:
    experiment = qtab.book.find(name)
    result = experiment.run()
    print(result, end="\n\n", flush=True)
    figure: Any = result.plot().figure
    path = folder / f"{experiment.name}.png"
    figure.savefig(path, dpi=DOTS_PER_INCH)
    Image.open(path).convert("RGB").save(path, optimize=True)

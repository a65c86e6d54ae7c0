"""SHA-256 digests of a store: one for each chunk of runs, and one over the study and all chunks."""

import hashlib
import json
import struct
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

StoredRun = tuple[Any, ...]
"""The index of a run, its seed, its summary columns (None if it failed), its learning curve and its error."""


def study_digest(meta: Mapping[str, str]) -> int:
    """Returns the digest of a study: of everything that a store says about itself except for the digest."""
    text = json.dumps({name: value for name, value in meta.items() if name != "digest"}, sort_keys=True)
    return int.from_bytes(hashlib.sha256(text.encode()).digest(), "big")


def chunk_digest(start: int, stop: int, seconds: float, runs: Iterable[StoredRun], place: int | None) -> int:
    """Returns the digest of a chunk, ``start`` to ``stop`` - 1, and of its runs as they are stored.

    Args:
        start: The index of the first run.
        stop: The index after the last run.
        seconds: The time that the runs took.
        runs: The runs.
        place: The place of their versions; None in stores of version 2, which do not hold it.
    """
    digest = hashlib.sha256(struct.pack("<qqd", start, stop, seconds))
    if place is not None:
        digest.update(struct.pack("<q", place))
    for run, seed, *summary, curve, error in runs:
        texts = [seed.encode(), curve, b"" if error is None else error.encode()]
        digest.update(struct.pack("<q?3q", run, error is None, *map(len, texts)))
        digest.update(b"".join(texts))
        if error is None:
            digest.update(struct.pack(f"<{len(summary)}d", *summary))
    return int.from_bytes(digest.digest(), "big")


def combined(study: int, chunks: Sequence[int]) -> int:
    """Returns the digest of a store, from that of its study and those of its chunks in any order.

    A commit updates it without reading the other chunks.
    """
    for chunk in chunks:
        study ^= chunk
    return study


def to_text(digest: int) -> str:
    """Returns a digest as 64 hexadecimal digits."""
    return f"{digest:064x}"

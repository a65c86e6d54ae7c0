"""A run in a store: its row, the check of the row, and the SHA-256 digests of chunks of rows."""

import hashlib
import json
import math
import struct
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from qtab.results.summary import FINAL_EPISODES

SUMMARY_COLUMNS = ("episodes", "steps", "mean_return", "final_return", "best_return", "terminated_rate")

StoredRun = tuple[Any, ...]
"""The index of a run, its seed, its summary columns (None if it failed), its learning curve and its error."""


@dataclass(frozen=True)
class RunRecord:
    """A run to be stored: its summary and learning curve, or the error with which it failed."""

    seed: int
    summary: dict[str, float | int] | None
    """A value for each of ``SUMMARY_COLUMNS``; None if the run failed."""
    curve: bytes
    """(blocks,) float64: the mean return of each whole block of episodes."""
    error: str | None = None

    def as_row(self, run: int) -> StoredRun:
        """Returns the row of the table ``runs`` for the run with this index, as SQLite returns it when it is read."""
        # SQLite does not store the sign of zero, nor lone surrogates.
        values = [None if self.summary is None else float(self.summary[name]) + 0.0 for name in SUMMARY_COLUMNS]
        error = None if self.error is None else self.error.encode(errors="replace").decode()
        return (run, str(self.seed), *values, self.curve, error)


def check_run(stored: StoredRun, config: Mapping[str, Any], expected_seed: int, block: int) -> None:
    """Checks that the values of a stored run are possible.

    Args:
        stored: The run.
        config: The config of its setting.
        expected_seed: The seed that its index gives it.
        block: The number of episodes that each point of its learning curve averages.

    Raises:
        ValueError: if a value is impossible; the message names it.
    """
    _, seed, *summary, curve, error = stored
    if seed != str(expected_seed):
        raise ValueError(f"its seed is {expected_seed}, not {_shown(seed)}")
    if not isinstance(curve, bytes) or not (error is None or isinstance(error, str)):
        raise ValueError("its learning curve or its error has the wrong type")
    if error is not None:
        if curve or any(value is not None for value in summary):
            raise ValueError("it failed, but has results")
        return
    if not all(isinstance(value, float) and math.isfinite(value) for value in summary):
        raise ValueError(f"its results are not finite numbers, but {_shown(tuple(summary))}")
    episodes, steps, mean, final, best, terminated = summary
    limit = config["max_episode_steps"]
    if episodes != config["episodes"]:
        raise ValueError(f"it has {config['episodes']} episodes, not {episodes:g}")
    if not (episodes <= steps <= episodes * limit and steps.is_integer()):
        raise ValueError(f"{episodes:g} episodes of at most {limit} steps cannot have {steps:g} steps")
    # A mean of equal numbers can exceed them by a few units in the last place.
    rounding = 1e-9 * abs(best)
    if max(mean, final) > best + rounding or (episodes <= FINAL_EPISODES and final != mean):
        raise ValueError(f"its mean, final and best return contradict each other: {mean:g}, {final:g}, {best:g}")
    if not 0 <= terminated <= 1:
        raise ValueError(f"its terminated_rate is {terminated:g}")
    if len(curve) != 8 * (config["episodes"] // block):
        raise ValueError(f"its learning curve has {len(curve)} bytes")


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 100 else f"{text[:97]}..."


def study_digest(meta: Mapping[str, str]) -> int:
    """Returns the digest of a study: of all metadata of its store except for the digest."""
    text = json.dumps({name: value for name, value in meta.items() if name != "digest"}, sort_keys=True)
    return int.from_bytes(hashlib.sha256(text.encode()).digest(), "big")


def chunk_digest(start: int, stop: int, seconds: float, runs: Iterable[StoredRun], place: int | None) -> int:
    """Returns the digest of a chunk, runs ``start`` to ``stop`` - 1, and of its stored rows.

    Args:
        start: The index of the first run.
        stop: The index after the last run.
        seconds: The time that the runs took.
        runs: The runs.
        place: The place of the runs' versions; None in stores of version 2, which do not hold it.
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
    """Returns the digest of a store, from the digests of its study and, in any order, its chunks.

    A commit can update it without reading the other chunks.
    """
    for chunk in chunks:
        study ^= chunk
    return study


def to_text(digest: int) -> str:
    """Returns a digest as 64 hexadecimal digits."""
    return f"{digest:064x}"

"""What a log holds that TensorBoard reads."""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any


def events(path: Path) -> Iterator[Any]:
    """Yields the events of a file: each is preceded by its length and a checksum, and followed by a checksum."""
    from tensorboardX.proto.event_pb2 import Event

    content, at = path.read_bytes(), 0
    while at < len(content):
        (length,) = struct.unpack_from("<Q", content, at)
        yield Event.FromString(content[at + 12 : at + 12 + length])
        at += 16 + length


def curves(folder: Path) -> dict[str, list[tuple[int, float]]]:
    """Returns the points of each curve in the only file of a folder: steps and values."""
    (path,) = folder.iterdir()
    found: dict[str, list[tuple[int, float]]] = {}
    for event in events(path):
        for value in event.summary.value:
            found.setdefault(value.tag, []).append((event.step, value.simple_value))
    return found


def purged_from(path: Path) -> int | None:
    """Returns the step from which a file replaces earlier ones; None if it replaces none."""
    from tensorboardX.proto.event_pb2 import SessionLog

    return next((event.step for event in events(path) if event.session_log.status == SessionLog.START), None)

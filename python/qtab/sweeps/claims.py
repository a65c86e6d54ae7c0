"""Who is training the runs that a store has claimed, and when a claim is lost."""

import os
import socket
import time
import uuid
from dataclasses import dataclass, field

HEARTBEAT_SECONDS = 5.0
"""The time between two heartbeats of a process, which keep its claims valid."""
CLAIM_EXPIRY_SECONDS = 60.0
"""A claim without a heartbeat for this long can be taken over by another process."""
MAX_CLAIM_SECONDS = 3600.0
"""A process that has nothing else to do takes over a claim that it has seen for this long, even with heartbeats."""


def new_owner() -> str:
    """Returns a name for a user of a store that tells its machine and process."""
    return f"{socket.gethostname()}/{os.getpid()}/{uuid.uuid4().hex}"


def describe(owner: object) -> str:
    """Returns what messages call an owner."""
    parsed = _parsed(owner)
    return "an unknown process" if parsed is None else f"process {parsed[1]} on {parsed[0]}"


@dataclass
class _Observed:
    heartbeat: object
    changed: float
    """When the heartbeat was first seen, on this process's clock."""
    since: float
    """When the claim was first seen, on this process's clock."""


@dataclass
class ClaimWatch:
    """Decides which claims of other processes are lost: it looks at their owners, and watches their heartbeats.

    The clock of another machine may be wrong, so a heartbeat in the future counts as long as it changes.
    """

    _observed: dict[tuple[object, ...], _Observed] = field(default_factory=dict)

    def is_lost(self, start: int, stop: int, owner: object, heartbeat: object) -> bool:
        """Returns whether nobody is training the runs of a claim any more."""
        parsed = _parsed(owner)
        if parsed is None or not isinstance(heartbeat, float):
            return True  # no process of this package writes this
        host, pid = parsed
        if host == socket.gethostname() and not _is_running(pid):
            return True
        now = time.monotonic()
        seen = self._observed.setdefault((start, stop, owner), _Observed(heartbeat, now, now))
        if seen.heartbeat != heartbeat:
            seen.heartbeat, seen.changed = heartbeat, now
        is_silent = time.time() - heartbeat > CLAIM_EXPIRY_SECONDS or now - seen.changed > CLAIM_EXPIRY_SECONDS
        return is_silent or now - seen.since > MAX_CLAIM_SECONDS


def _parsed(owner: object) -> tuple[str, int] | None:
    """Returns the machine and the process id of an owner; None if it is none."""
    parts = owner.split("/") if isinstance(owner, str) else []
    if len(parts) != 3 or not (parts[1].isascii() and parts[1].isdigit() and len(parts[1]) <= 10):
        return None
    return parts[0], int(parts[1])


def _is_running(pid: int) -> bool:
    if os.name != "posix":
        return True  # elsewhere os.kill(pid, 0) would end the process; the claim expires instead
    if pid == 0:
        return False  # os.kill(0, 0) would mean this process group
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        pass
    return True

"""Processes with a time limit, which end together with all processes that they started."""

import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Sequence
from contextlib import suppress


class Processes:
    """Runs commands, from several threads, and can stop all of them."""

    def __init__(self) -> None:
        self._running: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()
        self._stopped = False

    def output(self, command: Sequence[str], seconds: float) -> str:
        """Runs a command, and returns what it wrote to standard output until its end, or until it was killed.

        The output goes to a file, since a process that the command leaves behind would hold a pipe open.

        Args:
            command: The program and its arguments.
            seconds: The time limit.
        """
        with tempfile.TemporaryFile() as file:
            with self._lock:
                if self._stopped:
                    return ""
                process = subprocess.Popen(  # noqa: S603 - our own program
                    command, stdin=subprocess.DEVNULL, stdout=file, start_new_session=os.name == "posix"
                )
                self._running.add(process)
            try:
                with suppress(subprocess.TimeoutExpired):
                    process.wait(seconds)
            finally:
                _kill(process)
                process.wait()
                with self._lock:
                    self._running.discard(process)
            file.seek(0)
            return file.read().decode("utf-8", errors="replace")

    def stop(self) -> None:
        """Kills the processes that are running, and starts no more."""
        with self._lock:
            self._stopped = True
            for process in self._running:
                _kill(process)


def _kill(process: subprocess.Popen[bytes]) -> None:
    """Kills a process and, except on Windows, those that it started."""
    if sys.platform == "win32":
        process.kill()
    else:
        with suppress(ProcessLookupError, PermissionError):  # macOS: not permitted if all of them have ended
            os.killpg(process.pid, signal.SIGKILL)

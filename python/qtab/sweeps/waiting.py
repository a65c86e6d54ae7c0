"""Messages in the log about long waits."""

import logging
import time
from collections.abc import Callable

POLL_SECONDS = 0.5
"""The time between two looks at what others have done."""
NOTICE_SECONDS = 2.0
"""How long to wait for others before it is logged."""
NEXT_NOTICE_SECONDS = 60.0
"""The time after which it is logged again."""

_LOGGER = logging.getLogger("qtab")


class Notice:
    """Logs what a sweep is waiting for, if it waits long."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Ends a wait."""
        self._next = time.monotonic() + NOTICE_SECONDS

    def __call__(self, describe: Callable[[], str]) -> None:
        """Logs what is being waited for, if it is time."""
        now = time.monotonic()
        if now >= self._next:
            self._next = now + NEXT_NOTICE_SECONDS
            _LOGGER.warning("waiting for %s", describe())

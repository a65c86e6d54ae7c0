"""What a user should know and need not act on: said once, by the logger ``qtab``, which warns nobody."""

import logging

from qtab.resolution import Resolved

_LOGGER = logging.getLogger("qtab")
_limited: set[str] = set()
"""The environments whose want of a time limit was said in this process."""


def limit(resolved: Resolved) -> str:
    """Returns what there is to say where the time limit is ours (``resolved.limited``)."""
    config = resolved.config
    return f"{config.env} has no time limit of its own: an episode ends after {config.max_episode_steps:,} steps"


def say_limit(resolved: Resolved) -> None:
    """Says that the time limit is ours, where it is: once a process for each environment."""
    if resolved.limited and resolved.config.env not in _limited:
        _limited.add(resolved.config.env)
        _LOGGER.warning("%s; max_episode_steps= sets another", limit(resolved))

"""What every test stands on: no window opens, and CI draws the same examples every time."""

import os
import signal

import pytest

os.environ["SDL_VIDEODRIVER"] = "dummy"
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

from hypothesis import settings

settings.register_profile("local", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("ci" if os.environ.get("CI") else "local")


# A shell starts what runs in its background deaf to Ctrl-C, which some tests send.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def small_chunks(monkeypatch):
    """Some three runs a chunk."""
    from qtab.sweeps import study as studies

    monkeypatch.setattr(studies, "CHUNK_STEPS", 2 * 40 * 200 + 1)
    monkeypatch.setattr(studies, "PYTHON_CHUNK_STEPS", 1)

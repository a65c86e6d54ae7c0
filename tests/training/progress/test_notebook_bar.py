"""Progress bars in a notebook."""

import threading

import pytest

from qtab._utils.progress import notebook_bar


def test_the_bars_of_a_notebook_share_one_thread() -> None:
    pytest.importorskip("ipywidgets")
    tqdm = pytest.importorskip("tqdm")
    before = set(threading.enumerate())
    for _ in range(3):
        notebook_bar(total=1, delay=60.0).close()
    started = [type(thread) for thread in threading.enumerate() if thread not in before]
    assert started in ([], [tqdm.TMonitor])

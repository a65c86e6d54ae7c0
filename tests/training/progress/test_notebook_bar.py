"""Progress bars in a notebook."""

import threading

import pytest

from qtab._utils import progress


def test_the_bars_of_a_notebook_share_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ipywidgets")
    tqdm = pytest.importorskip("tqdm")
    # Without a thread that other bars have started, which the class would inherit.
    monkeypatch.setattr(tqdm.tqdm, "monitor", None)
    progress._widget_class.cache_clear()
    before = set(threading.enumerate())
    for _ in range(3):
        progress.notebook_bar(total=1, delay=60.0).close()
    started = [thread for thread in threading.enumerate() if thread not in before]
    assert [type(thread) for thread in started] == [tqdm.TMonitor]
    progress._widget_class.cache_clear()
    started[0].exit()  # type: ignore[attr-defined] # a TMonitor

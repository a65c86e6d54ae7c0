"""What every test relies on: no window opens, Ctrl-C arrives, and every run draws the same examples."""

import gc
import os
import signal
import sys
import warnings
from collections.abc import Iterator
from contextlib import suppress
from importlib import import_module

import pytest

os.environ["SDL_VIDEODRIVER"] = "dummy"
os.environ["MPLBACKEND"] = "agg"
# Every core has its worker already. NumPy reads this when it is first imported, here and in processes that tests start.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")

from hypothesis import HealthCheck, settings

from support import selection

# Warnings are errors in tests. That of SWIG, raised while Box2D is first imported, would crash the process.
with warnings.catch_warnings(), suppress(ModuleNotFoundError):
    warnings.simplefilter("ignore")
    import_module("Box2D")

# Everyone's tests draw the same examples every time. The profile "fuzz" draws new ones, every night. Neither limits the
# time, which depends on how busy the machine is.
patient = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True)
settings.register_profile("same", patient, max_examples=30, derandomize=True)
settings.register_profile("fuzz", patient, max_examples=1000)  # --hypothesis-profile fuzz
settings.load_profile("same")


# A shell starts its background jobs with Ctrl-C ignored; some tests send it.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """One worker process more than cores, as some tests wait for other processes; none where only files are named.

    For a few files, starting processes would take longer than the tests, and hide what they print.
    """
    named = config.args_source is pytest.Config.ArgsSource.ARGS
    if named and all(".py" in argument for argument in config.args):
        return 0
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return cores + 1


def pytest_configure(config: pytest.Config) -> None:
    """Leaves out the tests that need other libraries than the extra ``test`` installs, unless ``-m`` names them."""
    config.option.markexpr = selection.without_unnamed(config.option.markexpr)


@pytest.hookimpl(trylast=True)  # after -m has left tests out
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Starts the slow tests first where several processes share the tests."""
    processes = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    if processes > 1:
        items[:] = selection.slow_first(
            items, [item.get_closest_marker("slow") is not None for item in items], processes
        )


def pytest_collection_finish() -> None:
    """Spares the collector of garbage the thousands of tests and modules, of which it would never collect any."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 50)


@pytest.fixture(autouse=True)
def closed_figures() -> Iterator[None]:
    """Closes the figures that a test has left to pyplot, which warns of more than 20."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


@pytest.fixture
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Chunks of at most three runs, so that a small sweep has many."""
    from qtab.sweeps import worker

    monkeypatch.setattr(worker, "MAX_CHUNK_RUNS", 3)

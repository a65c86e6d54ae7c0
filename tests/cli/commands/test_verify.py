"""``qtab verify``: what it reports of a long comparison."""

import pytest

from qtab._utils.progress import ProgressBar
from qtab.cli.commands.verify import _announcer


def test_verify_without_a_bar_reports_once_how_long_it_will_take(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    clock = iter([0.0, 1.0, 5.0, 6.0])
    monkeypatch.setattr("qtab.cli.commands.verify.time.monotonic", lambda: next(clock))
    with ProgressBar(100, "episode", False) as bar:
        announce = _announcer("LunarLander-v3", bar)
        for done in (2, 10, 12):
            announce(done, 100)
    assert caplog.messages == [
        "LunarLander-v3 is stepped in Python to verify the run: 10 of 100 episodes took 5 s, all will take about 50 s"
    ]

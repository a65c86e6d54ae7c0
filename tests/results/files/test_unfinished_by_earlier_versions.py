"""Runs that an earlier build of 0.1.0 stopped resume to the bytes of an uninterrupted run.

The files in ``unfinished/`` were saved after a signal had stopped training on CliffWalking-v1, most of them within an
episode, those of Dyna-Q within the planning of a step. Do not regenerate them.
"""

from pathlib import Path

import pytest

import qtab

UNFINISHED = Path(__file__).with_name("unfinished")


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(path.stem for path in UNFINISHED.glob("*.npz")))
def test_an_unfinished_run_resumes_to_the_same_bytes(name: str, caplog: pytest.LogCaptureFixture) -> None:
    run = qtab.load(UNFINISHED / f"{name}.npz")
    assert 0 < len(run.episode_returns) < run.config.episodes
    caplog.clear()
    resumed, whole = qtab.resume(run), qtab.train(config=run.config)
    assert not caplog.records, "resume logs that a state does not fit"
    assert resumed.tables.tobytes() == whole.tables.tobytes()
    assert resumed.episode_returns.tobytes() == whole.episode_returns.tobytes()
    assert resumed.state == whole.state

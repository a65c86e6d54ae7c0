"""A run file through any sequence of training, saving, loading, resuming and damage: the right run, or one error."""

import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, precondition, rule

import qtab
from support.parity import assert_same_run

EPISODES = 12


@cache
def undisturbed(episodes: int) -> qtab.Run:
    """The run after so many of its episodes."""
    return qtab.train(
        "CliffWalking-v1",
        algorithm="sarsa_lambda",
        seed=4,
        episodes=EPISODES,
        max_episode_steps=60,
        callback=lambda progress: progress.episodes < episodes,
        callback_every=episodes,
    )


class RunFileMachine(RuleBasedStateMachine):
    """One file, how many episodes it should hold, and whether anything but the package has written to it."""

    def __init__(self) -> None:
        super().__init__()
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name) / "run.npz"
        self.episodes = 0
        self.saved = b""

    def teardown(self) -> None:
        self.folder.cleanup()

    def loaded(self) -> qtab.Run | None:
        message, run = "", None
        try:
            run = qtab.load(self.path)
        except ValueError as error:
            message = str(error)
        if run is None:
            assert "is not a run file" in message
            assert self.path.read_bytes() != self.saved
            return None
        assert_same_run(run, undisturbed(self.episodes))
        assert run.state == undisturbed(self.episodes).state
        return run

    def save(self, run: qtab.Run) -> None:
        run.save(self.path)
        self.episodes, self.saved = len(run.episode_returns), self.path.read_bytes()

    @rule(episodes=st.integers(1, EPISODES))
    def train(self, episodes: int) -> None:
        self.save(undisturbed(episodes))

    @precondition(lambda self: self.saved)
    @rule()
    def load(self) -> None:
        self.loaded()

    @precondition(lambda self: self.saved and self.episodes < EPISODES)
    @rule(more=st.integers(1, EPISODES))
    def resume(self, more: int) -> None:
        run, until = self.loaded(), min(self.episodes + more, EPISODES)
        if run is not None:
            self.save(qtab.resume(run, callback=lambda progress: progress.episodes < until, callback_every=1))
            assert self.loaded() is not None

    @precondition(lambda self: self.saved)
    @rule(place=st.floats(0, 1, exclude_max=True), value=st.integers(0, 255))
    def change_a_byte(self, place: float, value: int) -> None:
        content = bytearray(self.path.read_bytes())
        if content:
            content[int(place * len(content))] = value
            self.path.write_bytes(content)

    @precondition(lambda self: self.saved)
    @rule(place=st.floats(0, 1), count=st.integers(1, 100))
    def cut_out(self, place: float, count: int) -> None:
        content = self.path.read_bytes()
        start = int(place * len(content))
        self.path.write_bytes(content[:start] + content[start + count :])


TestRunFile: Any = RunFileMachine.TestCase
TestRunFile.settings = settings(
    max_examples=max(settings().max_examples // 2, 1), stateful_step_count=12, deadline=None
)
TestRunFile.pytestmark = [pytest.mark.slow]


@pytest.mark.parametrize("episodes", [1, EPISODES])
def test_the_undisturbed_run_has_so_many_episodes(episodes: int) -> None:
    assert len(undisturbed(episodes).episode_returns) == episodes

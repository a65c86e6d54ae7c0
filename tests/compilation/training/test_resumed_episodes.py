"""A run in compiled code that was stopped within an episode is resumed exactly, also where its steps fail there."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.environments.gym_classes import grids
from support.environments.gym_classes.grids import CliffEnv, MaskedGridEnv
from support.lockstep.compiled_runs import LONG, Grows, stopped, trained_until, windy
from support.parity import assert_same_run, run_of
from support.processes.posix import posix_only

pytest.importorskip("numba")


@pytest.fixture(autouse=True)
def _files_of_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@posix_only
@pytest.mark.parametrize("seconds", [0.02, 0.15])
def test_a_run_stopped_in_python_resumes_exactly(seconds: float, caplog: pytest.LogCaptureFixture) -> None:
    part = stopped(seconds, Grows, **LONG)
    assert part.state is not None
    finished = len(part.episode_returns) + 2
    resumed = trained_until(finished, Grows, part)
    assert "stopped within" not in caplog.text
    assert_same_run(resumed, trained_until(finished, Grows, **LONG))


@posix_only
def test_a_step_that_fails_after_a_run_was_resumed_is_taken_in_python() -> None:
    def make() -> Grows:
        return Grows(400_000, 400_050)

    part = stopped(0.004, make, **LONG)
    finished = len(part.episode_returns) + 1
    resumed = trained_until(finished, make, part)
    assert_same_run(resumed, trained_until(finished, make, **LONG))
    assert resumed.episode_lengths.tolist() == [400_050] * finished


@posix_only
def test_a_class_with_masks_and_steps_that_do_not_fail_resumes_exactly() -> None:
    settings = {**LONG, "action_mask": True, "max_episode_steps": 300, "epsilon": 1.0, "min_epsilon": 1.0}
    part = stopped(0.01, MaskedGridEnv, **settings)
    finished = len(part.episode_returns) + 2
    assert_same_run(trained_until(finished, MaskedGridEnv, part), trained_until(finished, MaskedGridEnv, **settings))


EARLIER: dict[str, Any] = {
    **{"episodes": 3_000, "max_episode_steps": 2_000, "seed": 3, "epsilon": 1.0, "min_epsilon": 1.0},
    **{"backend": "numba", "progress": False},
}


def test_a_state_of_an_earlier_version_resumes_to_the_same_bytes() -> None:
    """The file has the bytes of the environment's state instead of the actions of its episode."""
    stored = qtab.load(Path(__file__).parent / "stopped_within_an_episode.npz")
    finished = len(stored.episode_returns) + 2
    part = trained_until(1, windy, **EARLIER)
    results = ("tables", "episode_returns", "episode_lengths", "terminated", "state")
    part = replace(part, **{name: getattr(stored, name) for name in results})
    assert_same_run(trained_until(finished, windy, part), trained_until(finished, windy, **EARLIER))


def test_a_reward_that_is_not_finite_has_the_message_of_python() -> None:
    class Infinite(CliffEnv):
        def step(self, action):
            observation, _, terminated, _, _ = super().step(action)
            return observation, float("inf") if self.np_random.random() < 0.01 else 0.0, terminated, False, {}

    messages = []
    for backend in ("numba", "python"):
        with pytest.raises(ValueError, match="a finite number as the reward") as caught:
            qtab.train(gym.wrappers.TimeLimit(Infinite(), 50), backend=backend, seed=1, episodes=50)
        messages.append(str(caught.value))
    assert messages[0] == messages[1]
    assert "<TimeLimit<Infinite" in messages[0]


def test_large_arrays_are_shared_and_not_written_into() -> None:
    from qtab.compilation.twins.class_twin import LARGE, twin_of

    class Holds(CliffEnv):
        def __init__(self) -> None:
            super().__init__()
            self.picture, self.heights = np.ones(LARGE), np.zeros(LARGE)

        def step(self, action):
            self.heights[0] += 1.0
            return super().step(action)

    env = Holds()
    twin = twin_of(env)
    assert np.shares_memory(twin.picture, env.picture)
    assert not twin.picture.flags.writeable
    assert not np.shares_memory(twin.heights, env.heights)
    twin.step(0) if twin.reset() else None
    assert env.heights[0] == 0.0


class Wandering(CliffEnv):
    """Its episodes have no goal, and its state tells the ways to a cell apart."""

    def __init__(self) -> None:
        super().__init__(wind=0.4)
        self.goal = (-1, -1)

    def reset(self, *, seed=None, options=None):
        self.way = 0
        return super().reset(seed=seed, options=options)

    def step(self, action):
        observation, reward, terminated, truncated, info = super().step(action)
        self.way = (31 * self.way + self._to_state(self.position)) % 1_000_003
        return observation, reward, terminated, truncated, info


def test_an_edited_class_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    settings = {**LONG, "algorithm": "monte_carlo", "episodes": 1, "max_episode_steps": 20_000}
    with pytest.raises(MemoryError, match="memory_limit=150000") as caught:  # within the episode, at the same step
        qtab.train(Wandering(), memory_limit=150_000, **settings)
    part = run_of(caught.value)
    assert len(part.episode_returns) == 0
    monkeypatch.setattr(grids, "MOVES", {action: grids.MOVES[3 - action] for action in range(4)})
    with pytest.raises(ValueError, match=r"^run must be resumed in the environment as it was: .* within episode \d+"):
        qtab.resume(part, env=Wandering())

"""An episode that an exception ends is abandoned: a resumed run does not learn from its steps again."""

from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.config.choices import CHOICES
from support.parity import run_of

LEARNERS = [name for name in CHOICES["algorithm"] if name != "gradient_bandit"]
"""The bandit's episodes are single steps, after which nothing is left to learn from."""


class Chain(gym.Env[Any, Any]):
    """Three steps from a first state to the next ones; raises an exception, if given, at the third."""

    observation_space = gym.spaces.Discrete(7)
    action_space = gym.spaces.Discrete(2)

    def __init__(self, first: int, reward: float, raises: BaseException | None = None) -> None:
        # Not by the names of the arguments, by which a resumed run would notice the other environment.
        self.start, self.pays, self.error = first, reward, raises
        self.state = first

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[int, dict[str, Any]]:
        super().reset(seed=seed)
        self.state = self.start
        return self.state, {}

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        if self.error is not None and self.state == self.start + 2:
            raise self.error
        self.state += 1
        return self.state, self.pays, self.state == self.start + 3, False, {}


@pytest.mark.parametrize("algorithm", LEARNERS)
def test_a_resumed_run_learns_nothing_for_the_states_of_the_abandoned_episode(algorithm: Any) -> None:
    error = KeyboardInterrupt()
    settings: dict[str, Any] = {"algorithm": algorithm, "discount": 1.0, "initial_q": 0.0, "episodes": 2, "seed": 0}
    if algorithm == "dyna_q_plus":
        settings["time_weight"] = 0.0  # its bonus is a reward for all actions
    with pytest.raises(KeyboardInterrupt):
        qtab.train(Chain(0, 0.0, error), max_episode_steps=10, **settings)
    part = run_of(error)
    assert len(part.episode_returns) == 0
    # Nothing is learned from rewards of 0, and the other states are never followed by these.
    run = qtab.resume(part, env=Chain(3, 1.0))
    assert run.completed
    assert not run.tables[..., :3, :].any()
    assert run.tables.any()


def test_monte_carlo_control_averages_the_returns_of_the_finished_episodes() -> None:
    error = KeyboardInterrupt()
    settings: dict[str, Any] = {"algorithm": "monte_carlo", "discount": 1.0, "initial_q": 0.0, "epsilon": 0.0}
    settings |= {"episodes": 2, "seed": 0, "max_episode_steps": 10}
    with pytest.raises(KeyboardInterrupt):
        qtab.train(Chain(0, 1.0, error), **settings)
    resumed = qtab.resume(run_of(error), env=Chain(0, 1.0))
    assert resumed.q_table.tobytes() == qtab.train(Chain(0, 1.0), **settings).q_table.tobytes()

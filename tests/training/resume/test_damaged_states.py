"""The state of a run that somebody changed is refused by name, or resumed: it never causes a panic."""

from dataclasses import replace
from typing import Any

import pytest

import qtab

LIMITS: dict[str, Any] = {"CartPole-v1": {"low": (-2.4, -3, -0.21, -3), "high": (2.4, 3, 0.21, 3)}}


def resumes(run: qtab.Run, episodes: int) -> bool:
    """Whether a run is resumed; an error says that its state is not that of the run."""
    try:
        return qtab.resume(run, episodes).completed
    except ValueError as error:
        if not str(error).startswith("run must have an undamaged state from this version of qtab: the checkpoint "):
            raise
        return False


@pytest.mark.parametrize("env", ["MountainCar-v0", "Taxi-v4", "Blackjack-v1", "CartPole-v1"])
@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
def test_damaged_states_are_refused_or_resumed(env, backend):
    config: dict[str, Any] = {"algorithm": "n_step_sarsa", "seed": 4, "max_episode_steps": 9, "backend": backend}
    part = qtab.train(
        env,
        episodes=5,
        callback=lambda progress: progress.episodes < 3,
        callback_every=3,
        **LIMITS.get(env, {}),
        **config,
    )
    assert part.state is not None
    found = set()
    for index in range(len(part.state.checkpoint)):
        for value in (1, 255) if backend == "rust" else (1,):
            damaged = bytearray(part.state.checkpoint)
            damaged[index] = value
            found.add(resumes(replace(part, state=replace(part.state, checkpoint=bytes(damaged))), 4))
    assert found == {False, True}


def test_an_episode_that_python_steps_cannot_be_smuggled_into_a_state():
    run = qtab.train("FrozenLake-v1", seed=1, episodes=3, backend="gymnasium", algorithm="q_learning")
    assert run.state is not None
    between, episode = run.state.checkpoint, bytes(8 + 8 + 8 + 1)  # an action, a return, a length, nothing unfinished
    for index in range(len(between)):  # one of the bytes says that the run is between two episodes
        if not between[index]:
            within = between[:index] + b"\1" + between[index + 1 :] + episode
            assert not resumes(replace(run, state=replace(run.state, checkpoint=within)), 4)

"""``time_aware=True``: the number of steps taken in the episode is part of the state."""

from typing import Any, get_args

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import TimeAwareObservation
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.config.choices import Algorithm
from support.environments import Chain
from support.learners.learner_settings import (
    BY_EPISODE,
    explorations,
    learning_rates,
    own_options,
    possible_explorations,
)

LAKE = "FrozenLake-v1"
ALGORITHMS = get_args(Algorithm)


def downhill(state: Any) -> Any:
    """No action to the left in odd states."""
    return [state % 2 == 0, True, True, True]


@st.composite
def lake_settings(draw: st.DrawFn) -> dict[str, Any]:
    algorithm = draw(st.sampled_from(ALGORITHMS))
    return {
        **draw(learning_rates(1.0, by_visits=algorithm not in BY_EPISODE, algorithm=algorithm)),
        **draw(explorations(possible_explorations(algorithm, {}))),
        "discount": draw(st.floats(0, 1)),
        **draw(own_options(algorithm)),
        "algorithm": algorithm,
        "initial_q": draw(st.sampled_from([0.0, 1.0, (-1.0, 1.0)])),
        "count_bonus": draw(st.sampled_from([0.0, 0.5])),
        "action_mask": draw(st.sampled_from([False, downhill])),
        "bit_generator": draw(st.sampled_from(["PCG64", "MT19937"])),
        "max_episode_steps": draw(st.sampled_from([1, 5, 30])),
        "seed": draw(st.integers(0, 2**32 - 1)),
        "episodes": draw(st.integers(4, 12)),
    }


@settings(max_examples=settings().max_examples // 2)
@given(lake_settings())
def test_random_settings_give_the_table_of_the_reference(chosen: dict[str, Any]) -> None:
    run = qtab.train(LAKE, time_aware=True, preset="tuned", backend="rust", **chosen)
    assert run.q_table.shape == (chosen["max_episode_steps"], 16, 4)
    verification = qtab.verify(run)
    assert verification.equal, f"{chosen}\n{verification}"


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_both_backends_give_the_identical_table(algorithm: Any) -> None:
    chosen: dict[str, Any] = {"algorithm": algorithm, "time_aware": True, "max_episode_steps": 20, "seed": 5}
    rust, python = (
        qtab.train(LAKE, backend=backend, episodes=10, visits=True, action_mask=downhill, **chosen)
        for backend in ("rust", "gymnasium")
    )
    assert rust.tables.tobytes() == python.tables.tobytes()
    for run in (rust, python):
        assert run.visits is not None
        assert run.visits.shape == (20, 16, 4)
        assert run.visits.sum() == run.episode_lengths.sum()
        # Each step of an episode counts in the part of the table for that step.
        assert run.visits.sum(axis=(1, 2)).tolist() == [(run.episode_lengths > step).sum() for step in range(20)]


class Cell:
    """The discretizer of what the wrapper observes: the step, and the cell of a grid of positions and velocities."""

    def __init__(self, limit: int) -> None:
        self.limit = limit

    def __call__(self, observation: Any) -> tuple[int, ...]:
        # The step after the last one is never a state that an action is taken in.
        step = min(int(observation["time"][0]), self.limit - 1)
        state = observation["obs"]
        if np.ndim(state) == 0:
            return step, int(state)
        low = np.array([-1.2, -0.07], np.float32)
        cell = np.round((state - low) * np.array([10.0, 100.0]), 0).astype(int)
        return step, *cell.tolist()


@pytest.mark.parametrize(("env", "shape"), [(LAKE, (16,)), ("MountainCar-v0", (19, 15))])
@pytest.mark.parametrize("algorithm", ["q_learning", "n_step_sarsa", "double_q_learning", "dyna_q"])
def test_the_wrapper_of_gymnasium_around_the_environment_gives_the_identical_table(
    env: str, shape: tuple[int, ...], algorithm: Any
) -> None:
    limit = 25
    chosen: dict[str, Any] = {"seed": 3, "episodes": 8, "epsilon": 0.5, "initial_q": (0.0, 0.1), "discount": 0.9}
    run = qtab.train(env, algorithm=algorithm, time_aware=True, preset=None, max_episode_steps=limit, **chosen)
    wrapped: Any = TimeAwareObservation(gym.make(env, max_episode_steps=limit), flatten=False)
    other = qtab.train(
        wrapped,
        algorithm=algorithm,
        discretizer=Cell(limit),
        shape=(limit, *shape),
        on_truncation="terminate",
        **{
            **chosen,
            **{name: getattr(run.config, name) for name in ("learning_rate", "terminal_update", "min_epsilon")},
        },
    )
    assert run.q_table.shape == other.q_table.shape
    assert run.q_table.tobytes() == other.q_table.tobytes()
    assert run.episode_returns.tobytes() == other.episode_returns.tobytes()


class EarlyChain(Chain):
    """Without a time limit; an episode may end early."""

    def step(self, action: int) -> Any:
        observation, reward, over, _, info = super().step(action)
        return observation, reward, over, bool(self.np_random.random() < 0.05), info


@pytest.mark.parametrize("algorithm", ["q_learning", "monte_carlo", "prioritized_sweeping", "actor_critic"])
@pytest.mark.parametrize("cells", [{"scale": (4,)}, {"discretizer": "bins", "bins": 5}])
def test_an_environment_in_python_gives_the_table_of_the_reference(algorithm: Any, cells: dict[str, Any]) -> None:
    run = qtab.train(
        EarlyChain(), algorithm=algorithm, time_aware=True, max_episode_steps=15, seed=2, episodes=30, **cells
    )
    assert run.terminated.any()
    assert not run.terminated.all()
    assert qtab.verify(run, env=EarlyChain()).equal


def test_values_end_at_the_time_limit() -> None:
    """A reward of 1 for every step: the value after t steps is the number of steps left."""
    one = qtab.TabularEnv({0: {0: [(1.0, 0, 1.0, False)]}}, [1.0])
    run = qtab.train(
        one, time_aware=True, max_episode_steps=6, episodes=10, learning_rate=1.0, discount=1.0, initial_q=0.0
    )
    assert run.q_table.ravel().tolist() == [6.0, 5.0, 4.0, 3.0, 2.0, 1.0]


def test_many_runs_and_a_resumed_run_equal_single_runs() -> None:
    chosen: dict[str, Any] = {"time_aware": True, "max_episode_steps": 20, "episodes": 30}
    runs = qtab.train_many(LAKE, [7, 8], tables=True, **chosen)
    run = qtab.train(LAKE, seed=8, **chosen)
    assert runs[1].tables.tobytes() == run.tables.tobytes()
    assert runs[1].q_table.shape == (20, 16, 4)
    stopped = qtab.train(LAKE, seed=8, callback=lambda progress: progress.episodes < 11, callback_every=11, **chosen)
    assert not stopped.completed
    assert qtab.resume(stopped).tables.tobytes() == run.tables.tobytes()


def test_what_does_not_go_together_is_refused() -> None:
    cases: list[tuple[dict[str, Any], str]] = [
        ({"on_truncation": "bootstrap"}, "on_truncation must be 'terminate' for time_aware=True"),
        ({"discretizer": "tiles"}, "time_aware must be False for discretizer 'tiles', which has no cells, got True"),
        ({"max_rows": 50}, "time_aware must be False with max_rows, got True and max_rows=50"),
        ({"max_episode_steps": 10**9}, "time_aware must give a table of fewer than 2"),
    ]
    for chosen, message in cases:
        with pytest.raises(ValueError, match=message):
            qtab.train("MountainCar-v0", time_aware=True, episodes=1, **chosen)
    with pytest.raises(TypeError, match="time_aware must be True or False, got 1"):
        qtab.train("MountainCar-v0", time_aware=1, episodes=1)  # type: ignore[arg-type]


def test_the_limit_is_part_of_the_task_whatever_a_preset_or_a_config_says() -> None:
    run = qtab.train("MountainCar-v0", episodes=1, seed=0)
    assert run.config.on_truncation == "bootstrap"
    aware = qtab.train(config=run.config, time_aware=True)
    assert (aware.config.time_aware, aware.config.on_truncation) == (True, "terminate")
    assert qtab.Config(LAKE, time_aware=True).on_truncation == "terminate"
    assert run.config.replace(time_aware=True).on_truncation == "terminate"


@pytest.mark.slow
def test_the_preset_comes_within_half_a_percent_of_the_optimum() -> None:
    best = qtab.optimum(LAKE)
    known = best.stationary
    assert known is not None
    runs = qtab.train_many(LAKE, [40_000, 40_001], preset="time_aware", tables=True)
    returns = best.gap(runs).greedy_return
    assert (returns >= 0.995 * best.expected_return).all()
    # No policy that ignores the time is as good.
    assert (returns > known.expected_return).all()


def test_the_presets_are_those_of_the_lakes() -> None:
    for env in (LAKE, "FrozenLake8x8-v1"):
        run = qtab.train(env, preset="time_aware", episodes=2, seed=0)
        assert run.config.time_aware
        assert run.config.on_truncation == "terminate"

"""``predict(deterministic=False)`` draws from the behaviour policy as it was at the end of the training."""

import pickle
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.config.schedules import epsilon
from qtab.reference import agent_stream
from qtab.reference.parts.schedules import epsilon_schedule
from qtab.results.action_values import action_probabilities, sample

LAKE = "FrozenLake-v1"


def shares(run: qtab.Run, observation: Any, count: int = 4000) -> list[float]:
    """How often each action is drawn for an observation."""
    drawn, _ = run.predict(np.full(count, observation), deterministic=False)
    return (np.bincount(drawn, minlength=len(run.actions)) / count).tolist()


def constant(value: float, **settings: Any) -> qtab.Run:
    return qtab.train(LAKE, seed=0, episodes=5, epsilon=value, epsilon_schedule="constant", **settings)


def test_an_epsilon_greedy_policy_explores_with_the_last_epsilon():
    run = constant(0.4)
    greedy, _ = run.predict(0)
    assert shares(run, 0) == pytest.approx([0.7 if action == greedy else 0.1 for action in range(4)], abs=0.03)


def test_an_epsilon_that_fell_to_zero_leaves_the_greedy_action():
    run = qtab.train("MountainCar-v0", seed=0, episodes=5)
    observations = np.array([[-0.5, 0.0], [0.1, 0.01]])
    assert run.predict(observations, deterministic=False)[0].tolist() == run.predict(observations)[0].tolist()


def test_random_ties_are_drawn_equally():
    run = constant(0.0, ties="random", learning_rate=0.0, initial_q=0.5)
    assert shares(run, 3) == pytest.approx([0.25] * 4, abs=0.03)
    assert shares(constant(0.0, ties="first", learning_rate=0.0, initial_q=0.5), 3) == [1.0, 0.0, 0.0, 0.0]


def test_an_action_that_a_state_does_not_have_is_never_drawn():
    initial_q = np.zeros((16, 4))
    initial_q[:, [0, 2]] = -np.inf
    run = constant(1.0, initial_q=initial_q)
    assert shares(run, 5) == pytest.approx([0.0, 0.5, 0.0, 0.5], abs=0.03)


def test_softmax_draws_by_its_probabilities():
    run = qtab.train(LAKE, seed=0, episodes=50, exploration="softmax", temperature=0.1, initial_q=(0.0, 0.3))
    weights = np.exp(run.q_values(0) / 0.1)
    assert shares(run, 0) == pytest.approx((weights / weights.sum()).tolist(), abs=0.03)


@pytest.mark.parametrize(
    "settings",
    [
        {"epsilon_schedule": "constant"},
        {"epsilon_schedule": "linear", "min_epsilon": 0.1, "epsilon_warm_up": 3},
        {"epsilon_schedule": "exponential", "epsilon_decay": 0.8, "min_epsilon": 0.2, "epsilon_warm_up": 1},
    ],
    ids=lambda settings: settings["epsilon_schedule"],
)
def test_epsilon_is_that_of_the_reference_after_each_episode(settings):
    config = qtab.train(LAKE, seed=0, episodes=12, epsilon=0.9, **settings).config
    expected = epsilon_schedule(config)
    for episodes in range(13):
        assert epsilon(config).after(episodes, 12) == pytest.approx(expected.value, abs=1e-12)
        expected.end_episode()


def test_a_stopped_run_explores_as_it_did_when_it_stopped():
    stopped = qtab.train(LAKE, seed=0, episodes=1000, epsilon=1.0, callback=lambda _: False, callback_every=1)
    greedy, _ = stopped.predict(0)
    assert shares(stopped, 0)[greedy] == pytest.approx(0.25, abs=0.03)


def test_the_draws_are_those_of_the_runs_seed_also_after_loading(tmp_path):
    run = constant(1.0)
    run.save(tmp_path / "run.npz")
    one, other = qtab.load(tmp_path / "run.npz"), pickle.loads(pickle.dumps(run))  # noqa: S301
    drawn = [[each.predict(0, deterministic=False)[0] for _ in range(20)] for each in (run, one, other)]
    assert drawn[0] == drawn[1] == drawn[2]
    assert len(set(drawn[0])) > 1


@pytest.mark.parametrize("bit_generator", ["PCG64", "MT19937"])
def test_the_draws_are_not_the_numbers_that_the_agent_trained_with(bit_generator):
    run = constant(1.0, bit_generator=bit_generator)
    drawn, _ = run.predict(np.zeros(100, np.int64), deterministic=False)
    agent, environment = agent_stream(0, bit_generator), np.random.default_rng(0)
    for stream in (agent, environment):
        assert drawn.tolist() != [int(len(run.actions) * stream.random()) for _ in drawn]


@pytest.mark.parametrize("count", [0, 1, 7])
def test_batches_and_actions_of_a_box_are_drawn(count):
    run = qtab.train("Pendulum-v1", seed=0, episodes=2, max_episode_steps=5, epsilon=1.0, epsilon_schedule="constant")
    drawn, state = run.predict(np.zeros((count, 3), np.float32), deterministic=False)
    assert state is None
    assert drawn.shape == (count, 1)
    single, _ = run.predict(np.zeros(3, np.float32), deterministic=False)
    assert single.shape == (1,)
    assert single.dtype == np.float32


def test_deterministic_must_be_a_boolean():
    with pytest.raises(TypeError, match=r"^deterministic must be True or False, got 'no'$"):
        constant(0.5).predict(0, deterministic="no")  # type: ignore[arg-type]


def test_rounding_never_draws_an_action_of_probability_zero():
    class Largest:
        def random(self, shape: Any) -> Any:
            return np.full(shape, 1.0 - 2.0**-53)

    probabilities = np.array([[0.1] * 10 + [0.0], [0.0, 1 / 3, 1 / 3, 1 / 3, 0.0, 0, 0, 0, 0, 0, 0]])
    assert sample(probabilities, Largest()).tolist() == [9, 3]  # type: ignore[arg-type]
    config = constant(0.5).config
    assert action_probabilities(config, 5, np.zeros((3, 4))).sum(axis=1).tolist() == [1.0, 1.0, 1.0]


POLICIES: dict[str, dict[str, Any]] = {
    "epsilon_greedy": {"epsilon": 0.9, "epsilon_schedule": "constant"},
    "random_ties": {"epsilon": 0.2, "epsilon_schedule": "constant", "ties": "random", "initial_q": 0.0},
    "softmax": {"exploration": "softmax", "temperature": 0.5},
    "ucb": {"exploration": "ucb", "confidence": 1.0},
    "preferences": {"algorithm": "reinforce"},
    "two_tables": {"algorithm": "double_q_learning", "epsilon": 1.0, "epsilon_schedule": "constant"},
    "time_aware": {"time_aware": True, "max_episode_steps": 3, "epsilon": 1.0, "epsilon_schedule": "constant"},
    "trained_with_masks": {"action_mask": lambda _: [1, 1, 1, 1], "epsilon": 1.0, "epsilon_schedule": "constant"},
}


@pytest.mark.parametrize("name", POLICIES)
@pytest.mark.parametrize("mask", [[1, 0, 0, 0], [0, 0, 1, 0], [0, 1, 0, 1], [1, 1, 1, 1]], ids=str)
def test_only_actions_that_the_given_masks_allow_are_drawn(name: str, mask: list[int]) -> None:
    run = qtab.train(LAKE, seed=0, episodes=5, **POLICIES[name])
    allowed = np.flatnonzero(mask)
    drawn, _ = run.predict(np.full(400, 3), deterministic=False, action_masks=np.tile(mask, (400, 1)))
    assert set(drawn.tolist()) <= set(allowed.tolist())
    single = [run.predict(3, deterministic=False, action_masks=mask)[0] for _ in range(20)]
    assert set(single) <= set(allowed.tolist())
    if POLICIES[name].get("epsilon") == 1.0:
        expected = [bool(allows) / len(allowed) for allows in mask]
        assert (np.bincount(drawn, minlength=4) / 400).tolist() == pytest.approx(expected, abs=0.1)


def test_masks_of_a_batch_apply_to_their_own_observations() -> None:
    run = constant(1.0)
    masks = np.eye(4, dtype=np.int8)
    assert run.predict(np.arange(4), deterministic=False, action_masks=masks)[0].tolist() == [0, 1, 2, 3]
    car = qtab.train(
        "MountainCar-v0", seed=0, episodes=2, discretizer="tiles", epsilon=1.0, epsilon_schedule="constant"
    )
    observations = np.tile(np.array([-0.5, 0.0], np.float32), (60, 1))
    drawn, _ = car.predict(observations, deterministic=False, action_masks=np.tile([True, False, True], (60, 1)))
    assert set(drawn.tolist()) == {0, 2}


@pytest.mark.parametrize("deterministic", [True, False])
def test_masks_must_leave_an_action_that_the_state_has(deterministic: bool) -> None:
    initial_q = np.zeros((16, 4))
    initial_q[:, :2] = -np.inf
    run = constant(1.0, initial_q=initial_q)
    assert run.predict(5, deterministic=deterministic, action_masks=[1, 1, 0, 1])[0] == 3
    with pytest.raises(ValueError, match=r"^action_masks must allow an action that is not -inf in the run's initial_q"):
        run.predict(5, deterministic=deterministic, action_masks=[1, 1, 0, 0])

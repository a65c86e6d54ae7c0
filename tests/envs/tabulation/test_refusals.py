"""qtab.tabulate refuses what it cannot list exactly. The message names the place, the draw and the remedy."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv
from gymnasium.wrappers import TimeLimit, TransformReward

import qtab
from support.environments.own.control.mountain_car import MountainCar
from support.environments.own.small import Line, NoisyWalk, WindyGrid, line


def drawing(draw):
    """A Line that draws in state 3."""

    def transition(self, state, action, rng):
        if state == 3:
            draw(rng)
        return min(state + action, 4), -1.0, state + action >= 4

    return line(transition=transition)


def until(fits):
    """Draws until a value fits."""
    while not fits():
        pass


REFUSED_DRAWS = [
    (lambda rng: rng.normal(), "rng.normal"),
    (lambda rng: rng.poisson(2.0), "rng.poisson"),
    (lambda rng: rng.standard_normal(3), "rng.standard_normal"),
    (lambda rng: rng.bit_generator.random_raw(), "rng.bit_generator"),
    (lambda rng: int(rng.random() * 4), r"rng.random\(\), a continuous number that is computed with"),
    (lambda rng: float(rng.random()), r"rng.random\(\), a continuous number that is used as a number"),
    (lambda rng: np.searchsorted([0.2, 1.0], rng.random()), r"rng.random\(\), a continuous number"),
    (lambda rng: rng.random() == 0.5, r"rng.random\(\), a continuous number that is compared by =="),
    (lambda rng: rng.random(2), r"rng.random\(size=2\), several continuous numbers"),
    (lambda rng: rng.uniform(0, 2) + 1, r"rng.uniform\(0, 2\), a continuous number that is computed with"),
    (lambda rng: rng.integers(0, 100_000), r"rng.integers\(0, 100000\), which has 10,001 values"),
    (lambda rng: [rng.integers(0, 100) for _ in range(4)], r"rng.integers\(0, 100\) and more, .* 100,000 outcomes"),
    (lambda rng: rng.permutation(1000), "rng.permutation of 1000 items, which has more than 100,000 outcomes"),
    (lambda rng: rng.integers(0, 6, size=100), r"rng.integers\(0, 6, size=\(100,\)\), which has more than 100,000 out"),
    (lambda rng: rng.choice(6, 100), "rng.choice of 6 items, which has more than 100,000 outcomes"),
    (lambda rng: rng.random() < np.float16(0.3), r"compared with a float16, which rounds it .* with float\(\)"),
    (lambda rng: np.float32(0.3) > rng.random(), "compared with a float32, which rounds it"),
    (lambda rng: rng.random() < np.array([0.3], np.float32), "compared with a float32, which rounds it"),
    (lambda rng: rng.integers([1, 2]), "with an array of bounds"),
    (lambda rng: until(lambda: rng.integers(5) > 0), r"rng.integers\(5\) and more than 1,000 draws.* use rng.choice"),
    (lambda rng: until(lambda: rng.random() > 0.5), r"rng.random\(\) < 0.5 and more than 1,000 draws in one call"),
]


@pytest.mark.parametrize(("draw", "text"), REFUSED_DRAWS, ids=[text for _, text in REFUSED_DRAWS])
def test_a_draw_that_cannot_be_listed_is_refused_with_its_place_and_the_method_to_add(draw, text):
    with pytest.raises(ValueError, match=text) as refused:
        qtab.tabulate(drawing(draw))
    assert "transition of Line calls" in str(refused.value)
    assert "in state 3 for action 0. Add the method outcomes(self, state, action)" in str(refused.value)


def test_a_caught_refusal_is_still_one():
    def draw(rng):
        try:
            rng.normal()
        except Exception:
            return

    with pytest.raises(ValueError, match=r"calls rng.normal, whose outcomes cannot be listed, in state 3"):
        qtab.tabulate(drawing(draw))


def test_a_continuous_first_state_is_refused():
    with pytest.raises(
        ValueError, match=r"initial_state of MountainCar calls rng.uniform\(-0.6, -0.4\).*Add the method"
    ):
        qtab.tabulate(MountainCar())
    env = line(initial_state=lambda self, rng: (rng.random(), 0), observe=lambda self, state: 0.0)
    with pytest.raises(ValueError, match=r"calls rng.random\(\), a continuous number that is kept in state\[0\]"):
        qtab.tabulate(env)


def test_the_errors_of_numpy_and_of_the_environment_are_raised():
    with pytest.raises(ValueError, match="low >= high"):
        qtab.tabulate(drawing(lambda rng: rng.integers(3, 3)))
    with pytest.raises(ZeroDivisionError):
        qtab.tabulate(drawing(lambda rng: 1 // int(rng.integers(0, 2))))


def test_too_many_states_are_refused_with_the_numbers_that_grow():
    env = line(
        initial_state=lambda self, rng: (0, 0.0),
        transition=lambda self, state, action, rng: ((1 - state[0], state[1] + 0.5), -1.0, False),
        observe=lambda self, state: state[1],
    )
    with pytest.raises(ValueError, match=r"at most max_states=50 .*state\[1\] \(50 values from 0 to 24.5\)") as refused:
        qtab.tabulate(env, max_states=50)
    assert "state[0]" not in str(refused.value)
    assert len(qtab.tabulate(WindyGrid(), max_states=12).P) == 12
    with pytest.raises(ValueError, match="max_states=11 reachable states"):
        qtab.tabulate(WindyGrid(), max_states=11)
    with pytest.raises(ValueError, match="max_states=15 states, got a table P of 16"):
        qtab.tabulate(gym.make("FrozenLake-v1"), max_states=15)


@pytest.mark.parametrize(
    ("state", "text"),
    [
        (float("nan"), "state is NaN"),
        ((0, float("nan")), r"state\[1\] is NaN"),
        (object(), "state is a builtins.object, which cannot be compared"),
        ((0, np.random.default_rng(0)), r"state\[1\] is another random generator"),
        (np.array([None]), "state is a numpy.ndarray"),
    ],
    ids=["NaN", "NaN in a tuple", "object", "generator", "array of objects"],
)
def test_states_that_cannot_be_compared_are_refused(state, text):
    env = line(initial_state=lambda self, rng: state, observe=lambda self, state: 0.0)
    with pytest.raises(ValueError, match=f"env must have states of numbers, tuples and arrays, but in Line, {text}"):
        qtab.tabulate(env)


def test_other_action_spaces_are_refused():
    box = gym.spaces.Box(-1, 1, (1,), np.float32)
    with pytest.raises(
        ValueError, match=r"env must have a Discrete action space, got Box\(-1.0, 1.0, \(1,\), float32\)"
    ):
        qtab.tabulate(line(action_space=box))
    with pytest.raises(ValueError, match="Discrete action space, got MultiDiscrete"):
        qtab.tabulate(line(action_space=gym.spaces.MultiDiscrete([2, 2])))


def test_wrappers_that_may_change_numbers_are_refused_by_name():
    with pytest.raises(ValueError, match="no wrapper that may change observations, actions or rewards, got TransformR"):
        qtab.tabulate(TransformReward(TimeLimit(Line(), 5), lambda reward: 2 * float(reward)))


def test_other_arguments_are_refused():
    with pytest.raises(TypeError, match="env must be an environment, got 'FrozenLake-v1'"):
        qtab.tabulate("FrozenLake-v1")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="max_states must"):
        qtab.tabulate(Line(), max_states=0)


class Counter:
    """A function with a memory."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, self_, state, action, rng):
        self.calls += 1
        return min(state + action, 4), float(self.calls), state + action >= 4


def test_an_environment_that_is_no_function_of_its_state_is_refused():
    counter = Counter()
    env = line(transition=lambda self, state, action, rng: counter(self, state, action, rng))
    with pytest.raises(ValueError, match=r"must depend only on its arguments: .* in state 0 for action 0"):
        qtab.tabulate(env)

    def keeping(self, state, action, rng):
        self.steps = getattr(self, "steps", 0) + 1
        return min(state + action, 4), -1.0, state + action >= 4

    with pytest.raises(ValueError, match=r"a method of Line changed self\.steps"):
        qtab.tabulate(line(transition=keeping))

    def changing(self, state, action, rng):
        state[0] = min(state[0] + action, 4)
        return state, -1.0, state[0] == 4

    env = line(initial_state=lambda self, rng: np.zeros(1), transition=changing, observe=lambda self, state: state)
    with pytest.raises(ValueError, match=r"must not change the state that it is given, .* in state .* for action 1"):
        qtab.tabulate(env)


def test_draws_from_elsewhere_are_refused():
    with pytest.raises(ValueError, match=r"but Line or another thread drew from the module np\.random"):
        qtab.tabulate(drawing(lambda rng: np.random.rand()))  # noqa: NPY002 - the mistake


@pytest.mark.parametrize(
    ("returned", "error", "text"),
    [
        ((0, 1.0), TypeError, r"must return \(state, reward, terminated\), got \(0, 1.0\) in state 0 for action 0"),
        ((0, None, False), TypeError, "must return a number as the reward, got None"),
        ((0, float("inf"), False), ValueError, "must return a finite reward, got inf"),
        ((0, 1.0, 1), TypeError, "must return a boolean as terminated, got 1"),
    ],
    ids=repr,
)
def test_other_results_of_transition_are_refused(returned, error, text):
    with pytest.raises(error, match=text):
        qtab.tabulate(line(transition=lambda self, state, action, rng: returned))


@pytest.mark.parametrize(
    ("outcomes", "error", "text"),
    [
        ([(0.5, 0, -1.0, False)], ValueError, "must have probabilities that sum to 1, got 0.5 in state"),
        ([(1.5, 0, -1.0, False), (-0.5, 1, -1.0, False)], ValueError, r"probabilities in \[0, 1\]"),
        ([("half", 0, -1.0, False)], ValueError, r"probabilities in \[0, 1\]"),
        ([(1.0, 0, -1.0)], TypeError, r"must return a list of \(probability, state, reward, terminated\)"),
        (None, TypeError, r"must return a list of \(probability, state, reward, terminated\)"),
        (
            [(1.0, 2, -1.0, False)],
            ValueError,
            "must list every outcome of transition, which returned state [0134], rew",
        ),
        ([(1.0, 0, None, False)], TypeError, "outcomes of Listed must return a number as the reward, got None"),
    ],
    ids=repr,
)
def test_wrong_outcomes_are_refused(outcomes, error, text):
    env = type("Listed", (NoisyWalk,), {"outcomes": lambda self, state, action: outcomes})()
    with pytest.raises(error, match=text):
        qtab.tabulate(env)


@pytest.mark.parametrize(
    ("outcomes", "error", "text"),
    [
        ([(1.0, 1)], ValueError, "must list every first state, but initial_state returned 2"),
        ([(0.4, 1), (0.4, 2)], ValueError, "must have probabilities that sum to 1, got 0.8"),
        ([1, 2], TypeError, r"must return a list of \(probability, state\), got \[1, 2\]"),
    ],
    ids=repr,
)
def test_wrong_first_states_are_refused(outcomes, error, text):
    env = type("Listed", (NoisyWalk,), {"initial_outcomes": lambda self: outcomes})()
    with pytest.raises(error, match=text):
        qtab.tabulate(env)


class Dry(FrozenLakeEnv):
    """A frozen lake that never slips: each step is in its table, with another probability."""

    def step(self, action: Any) -> Any:
        _, self.s, reward, terminated = self.P[self.s][action][1]
        return self.s, reward, terminated, False, {}


class Elsewhere(FrozenLakeEnv):
    """A frozen lake that is always in state 5."""

    s: Any = property(lambda self: 5, lambda self, value: None)


class Pictured(FrozenLakeEnv):
    """A frozen lake with other pictures."""

    def render(self) -> Any:
        return None


def test_a_table_that_steps_do_not_follow_is_refused(monkeypatch):
    with pytest.raises(
        ValueError, match=r"its class Dry overrides step; qtab\.TabularEnv\(env\.P, env\.init.* follows"
    ):
        qtab.tabulate(Dry())
    below: Any = type("Below", (Dry,), {})
    with pytest.raises(ValueError, match="its class Dry overrides step"):
        qtab.tabulate(below())
    with pytest.raises(ValueError, match=r"env must follow its table P, but reset\(\) returned 5"):
        qtab.tabulate(Elsewhere())
    assert qtab.tabulate(Pictured()).P == qtab.tabulate(FrozenLakeEnv()).P
    env: Any = FrozenLakeEnv()
    env.step = lambda action: Dry.step(env, action)
    with pytest.raises(ValueError, match="its method step was replaced"):
        qtab.tabulate(env)
    with monkeypatch.context() as patch:
        patch.setattr(FrozenLakeEnv, "step", Dry.step)
        with pytest.raises(ValueError, match=r"FrozenLakeEnv\.step was replaced"):
            qtab.tabulate(FrozenLakeEnv())
    with pytest.raises(ValueError, match="fickle_passenger=True"):
        qtab.tabulate(gym.make("Taxi-v4", fickle_passenger=True))
    with pytest.raises(ValueError, match="its class BlockingMazeEnv overrides reset"):
        qtab.tabulate(gym.make("qtab/BlockingMaze-v0"))

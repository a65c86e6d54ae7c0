"""qtab.tabulate of ordinary Gymnasium classes: copies are stepped, and all attributes are the state."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv
from gymnasium.wrappers import TimeLimit

import qtab
from support.environments.own.gymnasium_class import Corridor, corridor


def best_values(length=5, slip=0.25):
    """Value iteration over (place, coin), by the rules of the corridor; the coin is 0 once it was found."""
    values = {(place, coin): 0.0 for place in range(length) for coin in range(3)}
    for _ in range(1000):
        for place, coin in values:
            if place == length - 1:
                continue
            totals = []
            for action in (-1, 1):
                total = 0.0
                for chance, move in ((1 - slip, action), (slip, -action)):
                    end = min(max(place + move, 0), length - 1)
                    found = end == coin and coin > 0
                    total += chance * ((5.0 if found else -1.0) + values[end, 0 if found else coin])
                totals.append(total)
            values[place, coin] = max(totals)
    return values


def test_a_class_has_the_values_of_its_rules_where_the_observation_hides_a_part():
    env = TimeLimit(Corridor(), 1000)
    table = qtab.tabulate(env)
    best = qtab.optimum(table, method="value_iteration")
    expected = best_values()
    assert np.allclose(table.initial_state_distrib[:2], [0.5, 0.5])
    for number, state in enumerate(table.states):
        coin = state["coins"][0] if state["coins"] else 0
        assert best.values[number] == pytest.approx(expected[state["place"], coin])
        assert table.observations[number] == state["place"]
    assert table.state_names[0] == "{'place': 0, 'coins': [1]}"
    run = qtab.train(table, episodes=3000, seed=0, discount=1.0, learning_rate=0.1, epsilon=0.3, preset=None)
    assert run.config.backend == "rust"
    assert qtab.optimum(table).gap(run).greedy_return == pytest.approx(qtab.optimum(table).expected_return, abs=0.05)


def test_the_environment_itself_is_not_stepped():
    env = Corridor()
    env.reset(seed=3)
    before = env.place, list(env.coins), env.np_random.bit_generator.state
    qtab.tabulate(env)
    assert before == (env.place, env.coins, env.np_random.bit_generator.state)


class HiddenTable(FrozenLakeEnv):
    """A frozen lake of which only the steps are known."""

    def __init__(self) -> None:
        super().__init__()
        self.known, self.first = self.P, self.initial_state_distrib
        del self.P, self.initial_state_distrib

    def reset(self, **arguments: Any) -> Any:
        self.initial_state_distrib = self.first
        try:
            return super().reset(**arguments)
        finally:
            del self.initial_state_distrib

    def step(self, action: Any) -> Any:
        self.P = self.known
        try:
            return super().step(action)
        finally:
            del self.P


def test_the_steps_of_a_frozen_lake_give_the_optimum_of_its_table():
    table = qtab.tabulate(TimeLimit(HiddenTable(), 100))
    known = qtab.optimum(gym.make("FrozenLake-v1"))
    assert qtab.optimum(table).expected_return == pytest.approx(known.expected_return, abs=1e-12)


def test_masks_are_those_of_the_info():
    def reset(self, **arguments):
        observation, _ = Corridor.reset(self, **arguments)
        return observation, {"action_mask": np.array([0, 1], np.int8)}

    def step(self, action):
        *others, _ = Corridor.step(self, action)
        return (*others, {"action_mask": np.array([self.place > 0, 1], np.int8)})

    table = qtab.tabulate(corridor(reset=reset, step=step))
    places = [state["place"] for state in table.states]
    assert table.masks is not None
    assert all(table.masks[number][0] == (place > 0) for number, place in enumerate(places))
    assert all(table.P[number][0][0][2] == -10_001.0 for number, place in enumerate(places) if place == 0)
    assert np.all(qtab.optimum(table).policy[np.array(places) == 0] == 1)


def changed(change):
    """A corridor whose steps also change something."""

    def step(self, action):
        answer = Corridor.step(self, action)
        return change(self, answer) or answer

    return corridor(step=step)


def count(env, answer):
    env.steps = getattr(env, "steps", 0) + 1


def own_generator(env, answer):
    env.rng = np.random.default_rng(0)


def replace_generator(env, answer):
    env.np_random = np.random.default_rng(0)


def sample(env, answer):
    env.action_space.sample()


def keep_closure(env, answer):
    env.place_of = lambda: env.place


CHANGES = [
    (sample, r"but Corridor or another thread drew from its action_space"),
    (keep_closure, r"self\.place_of is a function with variables of another function"),
    (count, r"found more after .*These numbers keep growing: self\.steps \("),
    (own_generator, r"in Corridor, self\.rng is another random generator"),
    (replace_generator, "must keep the generator np_random that it is given, but step of Corridor replaces it"),
    (lambda env, answer: env.np_random.normal() and None, r"step of Corridor calls rng\.normal.*for action 0"),
    (lambda env, answer: (*answer[:3], True, {}), r"must have its time limit in gymnasium\.wrappers\.TimeLimit"),
    (lambda env, answer: (answer[0], float("nan"), *answer[2:]), "must return a finite reward, got nan"),
    (lambda env, answer: setattr(env, "file", (item for item in "ab")), r"cannot .*generator|self\.file is a builtins"),
]


@pytest.mark.parametrize(
    ("change", "text"),
    CHANGES,
    ids=["sample", "closure", "counter", "generator", "replaced", "normal", "truncated", "NaN", "iterator"],
)
def test_what_cannot_be_copied_listed_or_compared_is_refused(change, text):
    with pytest.raises(ValueError, match=text):
        qtab.tabulate(changed(change), max_states=200)


def test_lists_that_are_one_object_differ_from_equal_lists():
    def step(self, action):
        one: list[int] = []
        self.pair = (one, one) if action else ([], [])
        return self.place, -1.0, False, False, {}

    states = qtab.tabulate(corridor(step=step)).states
    assert sum("pair" in state for state in states) == 4  # with a coin in one of two places


def test_references_to_itself_and_its_generator_are_no_new_states():
    def step(self, action):
        self.this, self.move, self.rng = self, self.step, self.np_random
        return Corridor.step(self, action)

    assert len(qtab.tabulate(corridor(step=step)).P) == len(qtab.tabulate(Corridor()).P) + 2  # before the first step


def test_an_environment_that_cannot_be_copied_is_refused():
    env: Any = Corridor()
    env.items = (item for item in "ab")
    with pytest.raises(ValueError, match=r"one that copy\.deepcopy copies, but Corridor raises TypeError"):
        qtab.tabulate(env)


def test_classic_control_is_refused_for_its_draw():
    with pytest.raises(ValueError, match=r"reset of MountainCarEnv calls rng\.uniform\(-0\.6, -0\.4\).*FunctionalEnv"):
        qtab.tabulate(gym.make("MountainCar-v0"))
    with pytest.raises(ValueError, match=r"reset of CartPoleEnv calls rng\.uniform.*size=\(4,\)"):
        qtab.tabulate(gym.make("CartPole-v1"))

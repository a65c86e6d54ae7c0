"""Messages for classes that cannot be compiled, and for classes and runs given where others are needed."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces

import qtab


class Walk(gym.Env[int, int]):
    """Eleven cells; without action masks."""

    observation_space: gym.Space[Any] = spaces.Discrete(11)
    action_space: gym.Space[Any] = spaces.Discrete(2)

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.cell = 5
        return self.cell, {}

    def step(self, action: int) -> Any:
        self.cell += 2 * action - 1
        return self.cell, 1.0, self.cell in (0, 10), False, {}


class Faulty(Walk):
    """Three problems, of which two are in functions that ``step`` calls, and one is met twice."""

    def weight(self) -> float:
        weight = np.exp(0.5 * self.cell)
        return 2 * float(weight)

    def other(self) -> float:
        return float(np.log(1.0 + self.cell))

    def step(self, action: int) -> Any:
        self.cell += 2 * action - 1
        gained = self.weight() + 1.0
        lost = self.other()
        more = self.other() + gained
        text = f"{lost}"
        rounded = round(more, 1)
        return self.cell, rounded, self.cell in (0, 10) or len(text) > 99, False, {}


class FaultyFunctions(qtab.FunctionalEnv):
    """Two constructs that cannot be compiled, in two methods."""

    observation_space: gym.Space[Any] = spaces.Discrete(11)
    action_space: gym.Space[Any] = spaces.Discrete(2)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return int(rng.choice(3))

    def transition(self, state: Any, action: Any, rng: np.random.Generator) -> Any:
        return state + int(rng.integers(2)), 0.0, state > 8

    def observe(self, state: Any) -> Any:
        return state


def message(call: Any) -> str:
    with pytest.raises((TypeError, ValueError)) as raised:
        call()
    return str(raised.value)


def test_all_problems_of_a_class_are_listed_with_their_lines() -> None:
    headline, *problems = message(lambda: qtab.train(Faulty(), backend="numba", episodes=1)).splitlines()
    assert headline == "the environment cannot be compiled, as backend='numba' asks, for these reasons:"
    expected = ["np.exp(0.5 * self.cell)", "np.log(1.0 + self.cell)", "f'{lost}'"]
    assert len(problems) == len(expected)
    lines = []
    for problem, code in zip(problems, expected, strict=True):
        assert code in problem
        assert "; " in problem  # the advice
        lines.append(int(problem.split("test_messages.py:")[1].split(":")[0]))
    assert lines == sorted(lines)


def test_all_problems_of_a_functional_environment_are_listed() -> None:
    text = message(lambda: qtab.train(FaultyFunctions(), backend="numba", episodes=1))
    assert "rng.choice(3)" in text
    assert "rng.integers(0, 2)" in text
    assert len(text.splitlines()) == 3


def test_many_problems_are_not_all_listed() -> None:
    from qtab.compilation.not_compilable import MOST_PROBLEMS, NotCompilable, combined

    found = combined([NotCompilable("a reason", "file.py", line % 15) for line in range(30)])
    assert len(found.others) == 14
    assert found.problems[0] == "file.py:0: a reason"
    assert found.problems[MOST_PROBLEMS:] == ["and 5 more"]


@pytest.mark.parametrize("call", [qtab.train, qtab.tabulate], ids=["train", "tabulate"])
def test_a_class_given_for_an_environment_is_named_as_an_instance(call: Any) -> None:
    assert message(lambda: call(Walk)).endswith("; pass an instance, Walk()")
    assert message(lambda: call(lambda: Walk())).endswith("; pass the environment that it makes")
    assert message(lambda: call(3)).endswith("got 3")


def test_a_vector_environment_of_a_class_leads_to_the_one_that_takes_it() -> None:
    for given in (Walk, Walk()):
        text = message(lambda given=given: qtab.RustVectorEnv(given))
        assert "name must be an environment id, got " in text
        assert text.endswith("; call gymnasium.register('my/Walk-v0', Walk) and pass 'my/Walk-v0'")
    text = message(lambda: qtab.RustVectorEnv(FaultyFunctions))  # type: ignore[arg-type]
    assert "gymnasium.register('my/FaultyFunctions-v0', FaultyFunctions)" in text


def test_several_runs_given_for_one_lead_to_their_tables() -> None:
    runs = qtab.train_many("FrozenLake-v1", seeds=2, episodes=2)
    assert "pass one of them, as in `for run in runs`" in message(lambda: qtab.evaluate(runs))  # type: ignore[arg-type]


def test_missing_action_masks_lead_to_the_method() -> None:
    pytest.importorskip("numba")
    text = message(lambda: qtab.train(Walk(), action_mask=True, episodes=1, backend="numba"))
    assert "write a method action_masks(self)" in text

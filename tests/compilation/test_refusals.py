"""What cannot be compiled is refused with the line and the advice; what differs is found before the first run."""

import random
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces

import qtab
from qtab.compilation import NotCompilable
from qtab.compilation.functional import capsule_of

pytest.importorskip("numba")


class Base(qtab.FunctionalEnv):
    observation_space: gym.Space[Any] = spaces.Box(-1e9, 1e9, (1,), np.float64)
    action_space: gym.Space[Any] = spaces.Discrete(2)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return rng.random()

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return state + action, 0.0, state > 5

    def observe(self, state: Any) -> Any:
        return state


class OneArgument(Base):
    def initial_state(self, rng: np.random.Generator) -> Any:
        return rng.integers(5) / 2  # here


class Choice(Base):
    def initial_state(self, rng: np.random.Generator) -> Any:
        return float(rng.choice(5))  # here


class GlobalGenerator(Base):
    def initial_state(self, rng: np.random.Generator) -> Any:
        return np.random.random()  # here  # noqa: NPY002


class StandardGenerator(Base):
    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return random.random(), 0.0, False  # here  # noqa: S311


class ChangesItself(Base):
    count = 0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        self.count += 1  # here
        return state, 0.0, self.count > 10


class ChangesAnArray(Base):
    observation_space = spaces.Box(-1e9, 1e9, (2,), np.float64)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return np.zeros(2)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        state[action] += 1.0  # here
        return state, 0.0, False


class ChangesItsList(Base):
    def __init__(self) -> None:
        self.visits = [0, 0]

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        self.visits[action] += 1  # here
        return state, 0.0, False


class ChangesShape(Base):
    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        if action == 1:
            return (state, state), 0.0, False  # here, or below: Numba names one of them
        return state, 0.0, False  # here


class ReadsADict(Base):
    def __init__(self) -> None:
        self.rewards = {0: 1.0, 1: 2.0}

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return state, self.rewards[action], False  # here


class DrawsUnknown(Base):
    def initial_state(self, rng: np.random.Generator) -> Any:
        return len(rng.bytes(4))  # here


class Clips(Base):
    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return float(np.clip(state + action, 0.0, 1.0)), 0.0, False  # here


class CallsItsBase(Base):
    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return super().transition(state, action, rng)  # here


class Powers(Base):
    def initial_state(self, rng: np.random.Generator) -> Any:
        return np.array([rng.random()])

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return np.array([rng.random()]), float((state**3)[0]), False  # here


class Exponentials(Base):
    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return rng.random(), float(np.exp(state * 3)), False  # here


class Overflows(Base):
    observation_space = spaces.Discrete(7)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 1

    def transition(self, state: int, action: int, rng: np.random.Generator) -> Any:
        return state * 1_000_003 % (10**18 + 9), 0.0, False

    def observe(self, state: int) -> int:
        return state % 7


class NoScalarSpace(Base):
    observation_space = spaces.Text(3)


class BoxActions(Base):
    action_space = spaces.Box(-1.0, 1.0, (1,))


class FloatObservation(Base):
    observation_space = spaces.Discrete(7)


class WrongShape(Base):
    observation_space = spaces.Box(-1.0, 1.0, (2,), np.float64)


class NamesTheState(Base):
    def initial_state(self, rng: np.random.Generator) -> Any:
        return {"x": 1.0}


class TwoValues(Base):
    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return state, 0.0


REFUSED: list[tuple[type[Base], str]] = [
    (OneArgument, r"rng.integers\(5\) cannot be compiled with one argument; write rng.integers\(0, 5\)"),
    (Choice, r"rng.choice\(5\) cannot be compiled; draw an index with rng.integers\(0, n\)"),
    (GlobalGenerator, r"np.random.random\(\) does not draw from the generator of the environment; draw from rng"),
    (StandardGenerator, r"random.random\(\) does not draw from the generator of the environment; draw from rng"),
    (ChangesItself, "self.count changes the environment; keep in the state what changes"),
    (ChangesAnArray, "Numba: an array of the state, or of self, is changed; copy the array first, and return the copy"),
    (ChangesItsList, r"self.visits\[action\] changes the environment; keep in the state what changes"),
    (ChangesShape, "its returns have different types; return equally many values everywhere, each always of one type"),
    (ReadsADict, "self.rewards contains a value of type dict"),
    (DrawsUnknown, "Unknown attribute 'bytes' of type NumPyRandomGeneratorType"),
    (Clips, r"Numba: clip\(float64, float64, float64\) is not available; write min\(max\(x, low\), high\)"),
    (CallsItsBase, r"super\(\) cannot be compiled; call a method of another name"),
    (Powers, r"a power can differ in the last bit.*; write products: x \* x for x \*\* 2"),
    (Exponentials, r"np.exp rounds differently in compiled code.*; write math.exp"),
]


@pytest.mark.parametrize(("made", "message"), REFUSED, ids=[made.__name__ for made, _ in REFUSED])
def test_a_construct_is_refused_with_its_line(made: type[Base], message: str) -> None:
    with pytest.raises(NotCompilable, match=message) as caught:
        capsule_of(made())
    refusal = caught.value
    assert refusal.file == __file__
    with open(__file__, encoding="utf-8") as lines:  # noqa: PTH123
        assert "# here" in lines.read().splitlines()[(refusal.line or 0) - 1]


OTHERS: list[tuple[type[Base], str]] = [
    (
        Overflows,
        r"step \d+, the error is 'an error' in compiled code and 'no error' in Python; integers beyond 64 bits",
    ),
    (NoScalarSpace, r"observations of Text\(.*\) cannot be compiled"),
    (BoxActions, r"the action space is not Discrete; number the actions, with spaces.Discrete\(n\)"),
    (FloatObservation, "observe returns float64 where the observation space has integers"),
    (WrongShape, r"observe returns float64 for a space of shape \(2,\)"),
    (
        NamesTheState,
        "the state is .* in compiled code, and dict in Python; a state is a number, an array, or a tuple of",
    ),
    (TwoValues, r"transition returns .*, not \(state, reward, terminated\)"),
]


@pytest.mark.parametrize(("made", "message"), OTHERS, ids=[made.__name__ for made, _ in OTHERS])
def test_other_refusals(made: type[Base], message: str) -> None:
    with pytest.raises(NotCompilable, match=message):
        capsule_of(made())


def test_a_refusal_is_remembered(caplog: pytest.LogCaptureFixture) -> None:
    for _ in range(2):
        with pytest.raises(NotCompilable, match=r"write math\.exp"):
            capsule_of(Exponentials())


class Starts(Base):
    """Fails at resets, for one of its attributes."""

    def __init__(self, start: float, bound: float = 10.0) -> None:
        self.start, self.bound = start, bound

    def initial_state(self, rng: np.random.Generator) -> Any:
        if self.start > self.bound:
            raise ValueError("too far")
        return self.start


def test_a_failing_reset_is_no_property_of_the_class() -> None:
    with pytest.raises(NotCompilable, match=r"^initial_state raises ValueError: too far$"):
        capsule_of(Starts(11.0))
    with pytest.raises(
        NotCompilable, match=r"^no episode can begin, because ValueError is raised: observe of Starts must"
    ):
        capsule_of(Starts(1e10, bound=1e11))
    capsule_of(Starts(1.0))


def test_spaces_without_bounds() -> None:
    class Unbounded(Base):
        observation_space = spaces.Box(-np.inf, np.inf, (1,), np.float64)

    env = gym.wrappers.TimeLimit(Unbounded(), 20)
    chosen: dict[str, Any] = {"discretizer": "bins", "bins": 5, "low": [0.0], "high": [6.0], "episodes": 5, "seed": 0}
    one, other = (qtab.train(env, backend=backend, **chosen) for backend in ("numba", "python"))
    assert one.q_table.tobytes() == other.q_table.tobytes()


def test_numba_can_be_disabled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    with pytest.raises(NotCompilable, match=r"^NUMBA_DISABLE_JIT is set$"):
        capsule_of(Base())


def test_without_numba_the_refusal_names_the_installation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("qtab.compilation.functional.is_installed", lambda: False)
    with pytest.raises(NotCompilable, match=r"^Numba is not installed; pip install numba$"):
        capsule_of(Base())
    with pytest.raises(ValueError, match=r"as backend='rust' asks: Numba is not installed; pip install numba$"):
        qtab.train(Base(), backend="rust", discretizer="bins", bins=2, episodes=1)

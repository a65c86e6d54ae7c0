"""NumPy functions that give other numbers in compiled code are refused, and conversions out of range are repeated."""

import re
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab

pytest.importorskip("numba")


class Base(qtab.FunctionalEnv):
    observation_space: gym.Space[Any] = gym.spaces.Discrete(10)
    action_space: gym.Space[Any] = gym.spaces.Discrete(2)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0, 0.5

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        time, x = state
        return (time + 1, 3.0 * x), float(self.reward(time, x)), time > 8

    def reward(self, time: int, x: float) -> Any:
        raise NotImplementedError

    def observe(self, state: Any) -> Any:
        return min(state[0], 9)


class Mod(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.mod(x, -3.0)


class FloorDivide(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.floor_divide(x, -3.0)


class Sign(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.sign(x)


class Shift(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.right_shift(8, time)


class Maximum(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.maximum(x, 0.0)


class Smallest(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.min(np.array([x, 0.0]))


class Largest(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.array([x, 0.0]).max()


class IntegerRemainder(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.fmod(time, 3)


class LargestNumber(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.nanmax(np.array([x, 0.0]))


class Spacing(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.spacing(x)


class TimesAPower(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.ldexp(x, time)


class Histogram(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.histogram(np.array([x, 0.5]), 3)[0][0]


class Range(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.arange(0.0, 1.0, 0.1)[3]


class DividedArray(Base):
    def reward(self, time: int, x: float) -> Any:
        return (np.array([x, 0.0]) // -3.0)[0]


class RemainderOfArray(Base):
    def reward(self, time: int, x: float) -> Any:
        left = np.array([x, 0.0])
        left %= -3.0
        return left[0]


class RemainderByArray(Base):
    def reward(self, time: int, x: float) -> Any:
        return (7 % np.array([time, 1]))[0]


class ShiftedArray(Base):
    def reward(self, time: int, x: float) -> Any:
        return (np.array([time, 0]) << 70)[0]


class ShiftedByArray(Base):
    def reward(self, time: int, x: float) -> Any:
        return (8 >> np.array([time, 0]))[0]


@pytest.mark.parametrize(
    ("cls", "message"),
    [
        (DividedArray, "// of arrays differs for some numbers, in `return (np.array([x, 0.0]) // -3.0)[0]`"),
        (RemainderOfArray, "write a loop over the elements"),
        (RemainderByArray, "write a loop over the elements"),
        (ShiftedArray, "write a loop over the elements"),
        (ShiftedByArray, "write a loop over the elements"),
        (IntegerRemainder, "write a % b"),
        (LargestNumber, "write a loop with max(x, y)"),
        (Spacing, "write a small number"),
        (TimesAPower, "multiply by the power of 2"),
        (Histogram, "count the elements in a loop"),
        (Range, "write low + step * np.arange(n)"),
        (Mod, "write a % b"),
        (FloorDivide, "write a // b"),
        (Sign, "compare the number with 0"),
        (Shift, "write a >> b"),
        (Maximum, "write max(x, y)"),
        (Smallest, "write a loop with min(x, y)"),
        (Largest, "write a loop with max(x, y)"),
    ],
)
def test_the_message_gives_the_line_and_what_to_write(cls: Any, message: str) -> None:
    with pytest.raises(ValueError, match=rf"{re.escape(__file__)}:\d+: .*{re.escape(message)}"):
        qtab.train(cls(), episodes=3, max_episode_steps=20, seed=0, backend="numba")


class LargestOfIntegers(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.maximum(time, 3) + np.min(np.array([time, 5]))


class DividedIntegers(Base):
    def reward(self, time: int, x: float) -> Any:
        cells = np.array([time - 4, 5])
        cells //= 2
        return cells[0] + (cells % 3)[1]


@pytest.mark.parametrize("cls", [LargestOfIntegers, DividedIntegers])
def test_those_of_integers_are_compiled(cls: Any) -> None:
    settings: dict[str, Any] = {"episodes": 5, "max_episode_steps": 20, "seed": 0}
    compiled = qtab.train(cls(), backend="numba", **settings)
    in_python = qtab.train(cls(), backend="python", **settings)
    assert compiled.tables.tobytes() == in_python.tables.tobytes()


class SmallInteger(Base):
    def reward(self, time: int, x: float) -> Any:
        return np.uint8(x)


class ElementOfSmallIntegers(Base):
    def reward(self, time: int, x: float) -> Any:
        small = np.zeros(2, np.int8)
        small[0] = x
        return small[0]


@pytest.mark.parametrize("cls", [SmallInteger, ElementOfSmallIntegers])
def test_a_float_outside_the_range_of_an_integer_is_not_wrapped(cls: Any) -> None:
    settings: dict[str, Any] = {"episodes": 3, "max_episode_steps": 20, "seed": 0}
    outcomes: list[Any] = []
    for backend in ("numba", "python"):
        try:
            outcomes.append(qtab.train(cls(), backend=backend, **settings).tables.tobytes())
        except (OverflowError, RuntimeError, ValueError) as error:
            outcomes.append(error)
    compiled, in_python = outcomes
    assert isinstance(compiled, Exception) or compiled == in_python
    assert isinstance(in_python, OverflowError) <= isinstance(compiled, OverflowError)

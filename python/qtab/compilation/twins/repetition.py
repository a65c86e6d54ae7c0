"""Calls that failed in compiled code, repeated in Python."""

import logging
import math
from typing import Any, TypeAlias

import numpy as np

from qtab.compilation.interface.qtab_env import TERMINATED, TRUNCATED
from qtab.compilation.layouts.attribute_record import restore
from qtab.compilation.twins.class_twin import ClassTwin, wrong_mask
from qtab.envs.external.positions import Position, generator_at, position_of

Result: TypeAlias = tuple[bytes, bytes, float, int, Position]
"""The observation and the action mask, the reward, the code as of ``qtab_step``, and the position of the generator."""

SHOWN = 80
"""The most characters of a value in a message, as in ``rust/python/src/runs/answers.rs``."""
ADVICE = "train with backend='gymnasium'"

_logger = logging.getLogger("qtab")
_logged: set[tuple[type, str]] = set()


class Repetition:
    """An episode that goes on in Python.

    Args:
        twin: The copy of the environment that is stepped.
        seed: The seed of the run.
        name: The name of the environment in messages, as Python stepping gives it.
        number: The type of the actions.
        reads_masks: Whether the run reads the action masks of states that are not terminal. Others are not computed.
    """

    def __init__(
        self,
        twin: ClassTwin,
        seed: int,
        name: str,
        number: type[int | np.int64] = int,
        reads_masks: bool = False,
    ) -> None:
        self._twin, self._seed, self._shown, self._number = twin, seed, name, number
        self._name, self._reads_masks = type(twin.env).__name__, reads_masks
        self._rng = np.random.default_rng(0)

    def reset(self, before: Position) -> Result:
        """Begins an episode, with the generator at a position."""
        return self._result("reset", self.begin(before), 0.0, 0)

    def begin(self, before: Position) -> Any:
        """Begins an episode, with the generator at a position, and returns the observation."""
        self._rng = generator_at(self._seed, before)
        return self._twin.reset_class(self._rng)

    def play(self, start: Position, actions: list[int], before: Position) -> None:
        """Repeats the steps of an episode.

        Args:
            start: The position of the generator before the reset.
            actions: The actions, counted from 0.
            before: The position of the generator after these steps in compiled code.

        Raises:
            RuntimeError: if it is another in Python.
        """
        self.begin(start)
        for action in actions:
            self.take(action)
        if position_of(self._rng, self._seed) != before:
            raise RuntimeError(f"{self._name} draws other random numbers in compiled code than in Python; {ADVICE}")

    def raise_error(self, state: bytes, before: Position, action: int) -> None:
        """Repeats a step from a state, in an episode whose beginning is not known, so that it raises the error.

        The types of the attributes are those after a reset, which may differ from those in the episode: the result
        is therefore not used.

        Raises:
            RuntimeError: if the step does not fail in Python.
        """
        self._twin.reset_class(np.random.default_rng(0))
        restore(self._twin.record, self._twin.env, state)
        self._rng = generator_at(self._seed, before)
        self.step(action)
        raise RuntimeError(
            f"{self._name} failed in compiled code, but not in Python, in an episode within which the run was resumed; "
            + ADVICE
        )

    def take(self, action: int) -> Any:
        """Takes an action, counted from 0, and returns what ``step`` of the class does."""
        return self._twin.step_class(action, self._rng, self._number)

    def step(self, action: int) -> Result:
        """Takes an action, counted from 0."""
        observation, reward, terminated, truncated, _ = self.take(action)
        if not _is_finite(reward):
            expected = "a finite number as the reward, as Gymnasium's API requires"
            raise ValueError(f"step of {self._shown} must return {expected}, got {_shortened(reward)}")
        code = TERMINATED * bool(terminated) + TRUNCATED * bool(truncated)
        return self._result("step", observation, float(reward), code)

    def log(self, what: str = "an episode of %s goes on in Python") -> None:
        """Logs that a call failed in compiled code only, and what follows: once for each class and consequence."""
        cls = type(self._twin.env)
        if (cls, what) not in _logged:
            _logged.add((cls, what))
            code = cls.step.__code__
            _logger.warning(
                f"%s:%s: {what}, which does not fail where compiled code does: with "
                "integers of more than 64 bits, integers beyond 2**53 in floats, an observation outside its space, "
                "a reward that is not finite, or an action mask that is not read",
                *(code.co_filename, code.co_firstlineno, cls.__name__),
            )

    def _result(self, method: str, given: Any, reward: float, code: int) -> Result:
        twin = self._twin
        numbers = twin.observed(given, with_mask=self._reads_masks and not code & TERMINATED)
        if twin.mask is not None:
            self._check_mask(method, given)
        observation = numbers["observation"]
        mask = numbers.get("action_mask", np.zeros(twin.num_actions, np.uint8))
        if len(observation) != twin.observation.size:
            raise ValueError(f"{self._name} returned an observation outside its space: {given!r}")
        return observation.tobytes(), mask.tobytes(), reward, code, position_of(self._rng, self._seed)

    def _check_mask(self, method: str, given: Any) -> None:
        """Raises the error of ``rust/python/src/runs/action_mask.rs`` for a wrong action mask."""
        wrong = wrong_mask(self._twin.mask, self._twin.num_actions)
        if wrong is not None:
            by_method = hasattr(self._twin.env, "action_masks")
            place = (
                f"action_mask({_shortened(given)})"
                if by_method
                else f"info['action_mask'] of {method} of {self._shown}"
            )
            raise ValueError(f"{place} must {wrong}, got {_shortened(self._twin.mask)}")


def _is_finite(reward: Any) -> bool:
    try:
        return math.isfinite(reward)
    except OverflowError:  # an integer beyond all floats
        return False


def _shortened(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."

"""The environment as the extension steps it, where its observations have to be read in Python first."""

from collections.abc import Callable
from typing import Any

import gymnasium as gym

from qtab.discretizers import Discretizer


class ObservedEnv(gym.Wrapper[Any, Any, Any, Any]):
    """Returns what a discretizer makes of the observations, and all else as it is."""

    def __init__(self, env: gym.Env, discretizer: Discretizer) -> None:
        super().__init__(env)
        self._discretizer = discretizer
        self.observation: Any = None
        """The last observation as the environment returned it."""

    def _observe(self, observation: Any) -> Any:
        self.observation = observation
        return self._discretizer.observe(observation)

    def __str__(self) -> str:
        """The environment's own text, which messages show."""
        return str(self.env)

    def reset(self, **kwargs: Any) -> Any:
        """Resets the environment. What is not an answer as Gymnasium's API says is left to the extension."""
        answer: Any = self.env.reset(**kwargs)
        if isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[1], dict):
            return self._observe(answer[0]), answer[1]
        return answer

    def step(self, action: Any) -> Any:
        """Steps the environment; see :meth:`reset`."""
        answer: Any = self.env.step(action)
        if isinstance(answer, tuple) and len(answer) == 5:
            return self._observe(answer[0]), *answer[1:]
        return answer

    def of_observation(self, function: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """Returns a function, such as one for action masks, that is given the environment's own observations."""
        return lambda _read: function(self.observation)

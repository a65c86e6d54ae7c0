"""The exploration rate and the learning rate of each episode of a run, for callbacks to show."""

from typing import TYPE_CHECKING

from qtab.config import Config

if TYPE_CHECKING:
    from qtab.reference.schedules import Schedule


class Rates:
    """The rates of a run by episode, with the bits that the learners use.

    The reference computes them, one episode after the other, and only when they are asked for.
    """

    def __init__(self, config: Config) -> None:
        self._config = config
        self._schedules: dict[str, tuple[int, Schedule]] = {}

    def epsilon(self, episode: int) -> float | None:
        """Returns the exploration rate of an episode, counted from 0; None unless it is epsilon-greedy."""
        return self._value("epsilon", episode) if self._config.exploration == "epsilon_greedy" else None

    def learning_rate(self, episode: int) -> float:
        """Returns the learning rate of an episode, counted from 0."""
        return self._value("learning_rate", episode)

    def _value(self, name: str, episode: int) -> float:
        reached, schedule = self._schedules.get(name) or (0, self._first(name))
        if reached > episode:
            reached, schedule = 0, self._first(name)
        if schedule.kind in ("linear", "exponential"):
            for _ in range(episode - reached):
                schedule.end_episode()
        self._schedules[name] = episode, schedule
        return float(schedule.value)

    def _first(self, name: str) -> "Schedule":
        # Imported here: training itself does not need the reference.
        from qtab.reference.schedules import LearningRate, epsilon_schedule

        return epsilon_schedule(self._config) if name == "epsilon" else LearningRate(self._config, (0, 0), 1).schedule

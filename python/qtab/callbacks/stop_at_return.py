"""``StopAtReturn``: stops a run that is good enough."""

import gymnasium as gym

from qtab._utils import checks
from qtab.config import Config
from qtab.training.callbacks import BaseCallback
from qtab.training.progress import Progress


class StopAtReturn(BaseCallback):
    """Stops the run as soon as the mean return of the last episodes reaches a value.

    The run keeps the schedules of its full number of episodes.

    Args:
        value: The mean return to reach.
        window: The number of last episodes to average. A run is not stopped before it has that many.
        every: The number of episodes between two checks; None takes ``callback_every``.

    Attributes:
        stopped_at: The number of episodes after which the value was reached; None until then.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """

    def __init__(self, value: float, window: int = 100, every: int | None = None) -> None:
        super().__init__(every)
        self.value = checks.finite("value", value)
        self.window = checks.integer("window", window, least=1)
        self.stopped_at: int | None = None

    def on_start(self, config: Config, env: gym.Env | None) -> None:  # noqa: ARG002
        """Resets ``stopped_at``."""
        self.stopped_at = None

    def __call__(self, progress: Progress) -> bool:
        """Returns whether to continue."""
        if progress.episodes < self.window or progress.returns[-self.window :].mean() < self.value:
            return True
        self.stopped_at = progress.episodes
        return False

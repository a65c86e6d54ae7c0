"""A callback that starts a timer, whose signal stops a run."""

import signal

import gymnasium as gym

import qtab
from qtab.callbacks import BaseCallback


class Timer(BaseCallback):
    """Starts a timer when training begins: while a run is set up, it could not be attached to the exception."""

    def __init__(self, seconds: float) -> None:
        super().__init__(every=10**9)
        self.seconds = seconds

    def on_start(self, config: qtab.Config, env: gym.Env | None) -> None:
        signal.setitimer(signal.ITIMER_VIRTUAL, self.seconds)

    def __call__(self, progress: qtab.Progress) -> None:
        pass

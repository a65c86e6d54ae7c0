"""Runs that the signal of a timer stops, most probably in the middle of an episode.

Where it strikes depends on the machine: the timer counts in ticks of up to 10 ms, and the extension hears a signal
every 10 ms. Tests assert what holds at any place, such as that a resumed run equals the uninterrupted one, and their
runs are so long that none is finished before.
"""

import gc
import signal
from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.callbacks import BaseCallback
from support.parity import run_of


class TimerError(Exception):
    """What the signal of the timer raises."""


class Timer(BaseCallback):
    """Starts a timer when training begins: while a run is set up, it could not be attached to the exception."""

    def __init__(self, seconds: float) -> None:
        super().__init__(every=10**9)
        self.seconds = seconds

    def on_start(self, config: qtab.Config, env: gym.Env | None) -> None:
        signal.setitimer(signal.ITIMER_VIRTUAL, self.seconds)

    def __call__(self, progress: qtab.Progress) -> None:
        pass


def stopped_by_a_timer(seconds: float, env: Any, error: type[BaseException] = TimerError, **settings: Any) -> qtab.Run:
    """The run that the exception carries, whose training took so many seconds of the processor's time."""

    def stop(*_: Any) -> None:
        raise error

    gc.disable()  # an exception raised while hypothesis's callback sees a collection would be lost
    before = signal.signal(signal.SIGVTALRM, stop)
    try:
        with pytest.raises(error) as caught:
            qtab.train(env, callback=Timer(seconds), **settings)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)
        gc.enable()
    return run_of(caught.value)

"""Ctrl-C stops a run of any length, and the exception carries what was learned."""

import json
import subprocess
import sys
from typing import Any

import pytest

from support.processes.interrupts import PRELUDE, in_a_process
from support.processes.posix import posix_only

pytestmark = posix_only


BACKENDS = ["rust", "gymnasium"]
SETTINGS = ["", "bit_generator='MT19937'", "record=3", "callback=print, callback_every=10**8"]
ENDLESS_EPISODE = """
once_it_trains(ctrl_c)
try:
    qtab.train("MountainCar-v0", backend={backend!r}, **ENDLESS)
except KeyboardInterrupt as interrupt:
    report(interrupt.run)
"""
BETWEEN_EPISODES = """
once_it_trains(ctrl_c)
try:
    qtab.train("MountainCar-v0", episodes=10**8, seed=0, {settings})
except KeyboardInterrupt as interrupt:
    run = interrupt.run
    count = len(run.episode_returns)
    again = qtab.train("MountainCar-v0", episodes=10**8, seed=0, callback=lambda progress: False,
                       callback_every=count, bit_generator=run.config.bit_generator)
    report(run, same=again.episode_returns.tobytes() == run.episode_returns.tobytes())
"""


@pytest.fixture(scope="module")
def interrupted() -> dict[str, dict[str, Any]]:
    """What is left of each run that Ctrl-C stopped, one after the other in a single process."""
    scripts = [ENDLESS_EPISODE.format(backend=backend) for backend in BACKENDS]
    scripts += [BETWEEN_EPISODES.format(settings=settings) for settings in SETTINGS]
    lines = in_a_process("".join(scripts)).stdout.splitlines()
    return dict(zip([*BACKENDS, *SETTINGS], map(json.loads, lines), strict=True))


@pytest.mark.parametrize("backend", BACKENDS)
def test_ctrl_c_stops_an_endless_episode_and_keeps_the_run(interrupted, backend):
    run = interrupted[backend]
    assert run["completed"] is False
    assert run["episodes"] == 0
    assert run["learned"] > 10
    assert run["finite"]


@pytest.mark.parametrize("settings", SETTINGS)
def test_ctrl_c_between_episodes_keeps_the_finished_ones(interrupted, settings):
    run = interrupted[settings]
    assert run["completed"] is False
    assert run["episodes"] > 0
    assert run["same"]


def test_an_uncaught_ctrl_c_ends_the_process_as_python_does():
    done = subprocess.run(
        [sys.executable, "-c", PRELUDE + "once_it_trains(ctrl_c)\nqtab.train('MountainCar-v0', **ENDLESS)"],
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode != 0
    assert done.stderr.rstrip().endswith("KeyboardInterrupt")


def test_an_exception_in_a_signal_handler_carries_the_run():
    done = in_a_process("""
class Enough(Exception): pass
def handler(number, frame):
    raise Enough
signal.signal(signal.SIGTERM, handler)
once_it_trains(lambda: os.kill(os.getpid(), signal.SIGTERM))
try:
    qtab.train("MountainCar-v0", **ENDLESS)
except Enough as enough:
    report(enough.run)
""")
    assert json.loads(done.stdout)["learned"] > 10


def test_a_signal_that_is_handled_does_not_stop_a_run():
    done = in_a_process("""
seen = []
signal.signal(signal.SIGTERM, lambda number, frame: seen.append(number))
def then():
    os.kill(os.getpid(), signal.SIGTERM)
    while not seen:
        time.sleep(0.01)
    ctrl_c()
once_it_trains(then)
try:
    qtab.train("MountainCar-v0", **ENDLESS)
except KeyboardInterrupt as interrupt:
    report(interrupt.run, seen=len(seen))
""")
    assert json.loads(done.stdout)["seen"] == 1


def test_other_python_threads_run_while_a_run_trains():
    # Only the other thread can end this run, after a million iterations of a Python loop.
    done = in_a_process("""
def count_and_stop():
    turns = 0
    while turns < 1_000_000:
        turns += 1
    _thread.interrupt_main()
once_it_trains(count_and_stop)
try:
    qtab.train("MountainCar-v0", **ENDLESS)
except KeyboardInterrupt as interrupt:
    report(interrupt.run)
""")
    assert json.loads(done.stdout)["learned"] > 10


def test_a_run_that_was_interrupted_within_a_step_goes_on_to_the_same_table():
    # An alarm interrupts the planning of a step again and again. It may also ring just before or after the call, which
    # is why the timer is set and stopped within the try statement.
    done = in_a_process("""
from qtab import _core
from qtab.training.setup.resolve import resolve
settings = {"algorithm": "dyna_q", "planning_steps": 10**6, "episodes": 2, "max_episode_steps": 3, "seed": 0}
resolved = resolve("CliffWalking-v1", settings)
signal.signal(signal.SIGALRM, signal.default_int_handler)
trainer = _core.Trainer(resolved.spec(), resolved.seed)
interrupts = 0
while True:
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.005)
        trainer.advance(2)
        signal.setitimer(signal.ITIMER_REAL, 0)
        break
    except KeyboardInterrupt:
        interrupts += 1
whole = qtab.train("CliffWalking-v1", **settings)
print(json.dumps([interrupts, trainer.tables().tobytes() == whole.tables.tobytes(),
                  trainer.episodes()[0].tobytes() == whole.episode_returns.tobytes()]))
""")
    interrupts, *same = json.loads(done.stdout)
    assert interrupts > 0
    assert same == [True, True]
